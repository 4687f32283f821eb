#include "bench/gpu_static/null_device.h"

#include "engine/drivers/matrix_offers.h"
#include "engine/drivers/matrix_units.h"
#include "engine/drivers/traits.h"
#include "engine/drivers/vulkan_result.h"
#include "xrds/error.h"

namespace xrds {
namespace {

// VK_KHR_cooperative_matrix, which the Vulkan headers of older systems lack.
constexpr auto kFeaturesType = static_cast<VkStructureType>(1000506000);
constexpr auto kPropertiesType = static_cast<VkStructureType>(1000506001);
constexpr const char* kExtension = "VK_KHR_cooperative_matrix";
struct CooperativeMatrixFeatures {
  VkStructureType sType = kFeaturesType;
  void* pNext = nullptr;
  VkBool32 cooperativeMatrix = VK_TRUE, robustBufferAccess = VK_FALSE;
};
struct CooperativeMatrixProperties {
  VkStructureType sType = kPropertiesType;
  void* pNext = nullptr;
  uint32_t MSize = 0, NSize = 0, KSize = 0;
  uint32_t a = 0, b = 0, c = 0, result = 0;  // 0: halves, 1: floats
  VkBool32 saturating = VK_FALSE;
  uint32_t scope = 0;
};

// Products of halves with sums in fp32, as findMatrixUnits() asks for.
void findUnits(const Instance& instance, VkPhysicalDevice device, DeviceDescription& description) {
  if (!hasDeviceExtension(device, kExtension)) return;
  const auto offered = offersOf<CooperativeMatrixProperties>(
      instance, device, "vkGetPhysicalDeviceCooperativeMatrixPropertiesKHR", kPropertiesType);
  const auto fits = [](const CooperativeMatrixProperties& p, uint32_t sums) {
    return p.a == 0 && p.b == 0 && p.c == sums && p.result == sums && p.scope == VK_SCOPE_SUBGROUP_NV;
  };
  const auto size = largestOf(offered, fits, 1u, 0u);
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device, &properties);
  if (!size || !holdsFragments(subgroupControl(device), registersOf(properties.vendorID, description.kind))) return;
  description.matrixUnits = MatrixUnits::khr;
  description.matrixSize = *size;
}

void open(Gpu::Handles& gpu) {
  VkPhysicalDeviceVulkan12Features features12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12};
  features.features.shaderInt64 = features12.shaderSubgroupExtendedTypes = VK_TRUE;
  features12.shaderFloat16 = features12.vulkanMemoryModel = VK_TRUE;
  VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR statistics{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR};
  statistics.pipelineExecutableInfo = VK_TRUE;
  features12.pNext = &statistics;
  VkPhysicalDeviceSubgroupSizeControlFeatures subgroups{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES};
  subgroups.subgroupSizeControl = subgroups.computeFullSubgroups = VK_TRUE;
  statistics.pNext = &subgroups;
  std::vector<const char*> extensions{VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME,
                                      VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME};
  CooperativeMatrixFeatures units;
  if (gpu.description.matrixUnits == MatrixUnits::khr) {
    subgroups.pNext = &units;
    extensions.push_back(kExtension);
  }
  createDevice(gpu, features, extensions);
  gpu.choosesSubgroups = subgroupControl(gpu.physicalDevice).areChosen;
}

}  // namespace

NullDevice::NullDevice(ProgramSource programs) {
  checkResult(volkInitialize(), "volkInitialize");
  handles_.instance = openInstance({});
  if (!handles_.instance) throw Error("There is no Vulkan driver.");
  volkLoadInstanceOnly(handles_.instance->instance);
  const auto found = findDevices(*handles_.instance);
  if (found.empty()) throw Error("There is no Vulkan device.");
  handles_.physicalDevice = found[0].physicalDevice;
  handles_.description = found[0].description;
  findUnits(*handles_.instance, handles_.physicalDevice, handles_.description);
  handles_.options.programs = std::move(programs);
  handles_.pipelineFlags =
      VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR | VK_PIPELINE_CREATE_CAPTURE_INTERNAL_REPRESENTATIONS_BIT_KHR;
  open(handles_);
}

bool NullDevice::runs(KernelFamily family) const {
  return !usesMatrixUnits(family) || description().matrixUnits != MatrixUnits::none;
}

DeviceTraits& NullDevice::take(KernelFamily family) {
  handles_.traits = traitsOf(handles_.physicalDevice, handles_.description, family, handles_.choosesSubgroups);
  return handles_.traits;
}

}  // namespace xrds
