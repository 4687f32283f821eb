#include "engine/drivers/traits.h"

#include "engine/drivers/llvmpipe.h"
#include "engine/drivers/matrix_units.h"
#include "engine/environment.h"

namespace xrds {

uint32_t registersOf(uint32_t vendorId, DeviceKind kind) {
  constexpr uint32_t kIntel = 0x8086, kApple = 0x106B, kQualcomm = 0x5143, kArm = 0x13B5, kBroadcom = 0x14E4;
  constexpr uint32_t kMesa = 0x10005;  // what its driver of Apple's GPUs gives
  if (kind == DeviceKind::cpu) return 4096;
  if (vendorId == kArm || vendorId == kBroadcom) return 64;
  const bool areFew = vendorId == kIntel || vendorId == kApple || vendorId == kMesa || vendorId == kQualcomm;
  return areFew ? 128 : 256;
}

DeviceTraits traitsOf(VkPhysicalDevice device, const DeviceDescription& description, KernelFamily family,
                      bool choosesSubgroups) {
  VkPhysicalDeviceVulkan11Properties version11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &version11};
  vkGetPhysicalDeviceProperties2(device, &properties);
  VkPhysicalDeviceVulkan12Features features12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12};
  vkGetPhysicalDeviceFeatures2(device, &features);
  const VkPhysicalDeviceLimits& limits = properties.properties.limits;
  const SubgroupControl subgroups = subgroupControl(device);
  const uint32_t registers = registersOf(properties.properties.vendorID, description.kind);
  // Where registers are few, the matrix kernels need those that only small subgroups have.
  const bool areSmall = usesMatrixUnits(family) && choosesSubgroups && registers < DeviceTraits{}.registers;
  return {.family = family,
          .matrixUnits = description.matrixUnits,
          .matrixSize = description.matrixSize,
          .subgroupSize = areSmall ? subgroups.least : version11.subgroupSize,
          .leastSubgroup = choosesSubgroups ? subgroups.least : 0,
          .mostSubgroup = choosesSubgroups ? subgroups.most : 0,
          .maxGroupSubgroups = subgroups.mostOfGroup,
          .maxStorageBufferRange = limits.maxStorageBufferRange,
          .maxTexelBufferElements = limits.maxTexelBufferElements,
          .maxAllocationBytes = version11.maxMemoryAllocationSize,
          .memoryBytes = description.kind == DeviceKind::cpu ? 0 : description.memoryBytes,
          .secondCacheBytes = secondCacheBytes(),
          .registers = registers,
          .maxSharedBytes = limits.maxComputeSharedMemorySize,
          .maxGroupInvocations = limits.maxComputeWorkGroupInvocations,
          .shaderInt64 = features.features.shaderInt64 && features12.shaderSubgroupExtendedTypes,
          .laneCode = llvmpipeTraits(description.driver).laneCode,
          .bufferAddresses = description.kind == DeviceKind::cpu && features12.bufferDeviceAddress};
}

}  // namespace xrds
