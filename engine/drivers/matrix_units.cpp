#include "engine/drivers/matrix_units.h"

#include "engine/drivers/matrix_offers.h"

// Only where the compiler of the kernels knows the extension, too.
#if defined(XRDS_MATRIX_KHR) && defined(VK_KHR_cooperative_matrix)
#define XRDS_USES_KHR
#endif

namespace xrds {
namespace {

// Whether the device has the feature of the extension, and what it needs beside it.
template <class Features>
bool hasFeatures(VkPhysicalDevice device, Features wanted) {
  VkPhysicalDeviceVulkan12Features features12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &wanted};
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12};
  vkGetPhysicalDeviceFeatures2(device, &features);
  return wanted.cooperativeMatrix && features12.shaderFloat16 && features12.vulkanMemoryModel;
}

std::optional<MatrixSize> sizeOfNv(const Instance& instance, VkPhysicalDevice device) {
  const auto offered =
      offersOf<VkCooperativeMatrixPropertiesNV>(instance, device, "vkGetPhysicalDeviceCooperativeMatrixPropertiesNV",
                                                VK_STRUCTURE_TYPE_COOPERATIVE_MATRIX_PROPERTIES_NV);
  const auto fits = [](const VkCooperativeMatrixPropertiesNV& p, VkComponentTypeNV sums) {
    return p.AType == VK_COMPONENT_TYPE_FLOAT16_NV && p.BType == VK_COMPONENT_TYPE_FLOAT16_NV && p.CType == sums &&
           p.DType == sums && p.scope == VK_SCOPE_SUBGROUP_NV;
  };
  return largestOf(offered, fits, VK_COMPONENT_TYPE_FLOAT32_NV, VK_COMPONENT_TYPE_FLOAT16_NV);
}

#ifdef XRDS_USES_KHR
std::optional<MatrixSize> sizeOfKhr(const Instance& instance, VkPhysicalDevice device) {
  const auto offered =
      offersOf<VkCooperativeMatrixPropertiesKHR>(instance, device, "vkGetPhysicalDeviceCooperativeMatrixPropertiesKHR",
                                                 VK_STRUCTURE_TYPE_COOPERATIVE_MATRIX_PROPERTIES_KHR);
  const auto fits = [](const VkCooperativeMatrixPropertiesKHR& p, VkComponentTypeKHR sums) {
    return p.AType == VK_COMPONENT_TYPE_FLOAT16_KHR && p.BType == VK_COMPONENT_TYPE_FLOAT16_KHR && p.CType == sums &&
           p.ResultType == sums && p.scope == VK_SCOPE_SUBGROUP_KHR;
  };
  return largestOf(offered, fits, VK_COMPONENT_TYPE_FLOAT32_KHR, VK_COMPONENT_TYPE_FLOAT16_KHR);
}
#endif

}  // namespace

// Kernels share their work among subgroups whose number they know.
SubgroupControl subgroupControl(VkPhysicalDevice device) {
  if (!hasDeviceExtension(device, VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME)) return {};
  VkPhysicalDeviceSubgroupSizeControlProperties sizes{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &sizes};
  vkGetPhysicalDeviceProperties2(device, &properties);
  MatrixFeatures features;
  VkPhysicalDeviceFeatures2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features.subgroups};
  vkGetPhysicalDeviceFeatures2(device, &all);
  return subgroupControl(features.subgroups, sizes);
}

SubgroupControl subgroupControl(const VkPhysicalDeviceSubgroupSizeControlFeatures& features,
                                const VkPhysicalDeviceSubgroupSizeControlProperties& sizes) {
  const bool areChosen =
      features.subgroupSizeControl && (sizes.requiredSubgroupSizeStages & VK_SHADER_STAGE_COMPUTE_BIT);
  const bool isOne = sizes.minSubgroupSize == sizes.maxSubgroupSize;
  return {.areKnown = features.computeFullSubgroups && (areChosen || isOne),
          .areChosen = areChosen && !isOne,
          .least = sizes.minSubgroupSize,
          .most = sizes.maxSubgroupSize,
          .mostOfGroup = sizes.maxComputeWorkgroupSubgroups};
}

std::pair<MatrixUnits, MatrixSize> findMatrixUnits(const Instance& instance, VkPhysicalDevice device) {
  if (!subgroupControl(device).areKnown) return {};
  const MatrixFeatures features;
  if (hasDeviceExtension(device, VK_NV_COOPERATIVE_MATRIX_EXTENSION_NAME) && hasFeatures(device, features.nv))
    if (const auto size = sizeOfNv(instance, device)) return {MatrixUnits::nv, *size};
#ifdef XRDS_USES_KHR
  if (hasDeviceExtension(device, VK_KHR_COOPERATIVE_MATRIX_EXTENSION_NAME) && hasFeatures(device, features.khr))
    if (const auto size = sizeOfKhr(instance, device)) return {MatrixUnits::khr, *size};
#endif
  return {};
}

bool holdsFragments(const SubgroupControl& subgroups, uint32_t registers) {
  constexpr uint32_t kLeastBytes = 8192;  // the sums of two fragments of 16 x 16, and as much for each operand
  return subgroups.least * registers * 4 >= kLeastBytes;
}

std::vector<const char*> extensionsOf(MatrixUnits units, bool choosesSubgroups) {
  std::vector<const char*> extensions;
  if (units == MatrixUnits::nv) extensions.push_back(VK_NV_COOPERATIVE_MATRIX_EXTENSION_NAME);
  if (units == MatrixUnits::khr) extensions.push_back("VK_KHR_cooperative_matrix");
  if (choosesSubgroups || !extensions.empty()) extensions.push_back(VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME);
  return extensions;
}

void MatrixFeatures::enable(MatrixUnits units, bool choosesSubgroups, VkPhysicalDeviceVulkan12Features& features) {
  const bool hasUnits = !extensionsOf(units).empty();
  if (!hasUnits && !choosesSubgroups) return;
  subgroups.subgroupSizeControl = choosesSubgroups;
  subgroups.computeFullSubgroups = hasUnits;
  subgroups.pNext = features.pNext;
  features.pNext = &subgroups;
  if (!hasUnits) return;
  features.shaderFloat16 = features.vulkanMemoryModel = VK_TRUE;
  const auto chain = [&features](auto& wanted) {
    wanted.cooperativeMatrix = VK_TRUE;
    wanted.pNext = features.pNext;
    features.pNext = &wanted;
  };
  if (units == MatrixUnits::nv) chain(nv);
#ifdef VK_KHR_cooperative_matrix
  if (units == MatrixUnits::khr) chain(khr);
#endif
}

}  // namespace xrds
