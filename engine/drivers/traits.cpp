#include "engine/drivers/traits.h"

#include "engine/drivers/llvmpipe.h"
#include "engine/drivers/matrix_units.h"
#include "engine/environment.h"

namespace xrds {

DeviceTraits traitsOf(VkPhysicalDevice device, const DeviceDescription& description, KernelFamily family) {
  VkPhysicalDeviceVulkan11Properties version11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &version11};
  vkGetPhysicalDeviceProperties2(device, &properties);
  VkPhysicalDeviceVulkan12Features features12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12};
  vkGetPhysicalDeviceFeatures2(device, &features);
  const VkPhysicalDeviceLimits& limits = properties.properties.limits;
  const SubgroupControl subgroups = subgroupControl(device);
  return {.family = family,
          .matrixUnits = description.matrixUnits,
          .matrixSize = description.matrixSize,
          .subgroupSize = version11.subgroupSize,
          .leastSubgroup = subgroups.areChosen ? subgroups.least : 0,
          .mostSubgroup = subgroups.areChosen ? subgroups.most : 0,
          .maxGroupSubgroups = subgroups.mostOfGroup,
          .maxStorageBufferRange = limits.maxStorageBufferRange,
          .maxTexelBufferElements = limits.maxTexelBufferElements,
          .maxAllocationBytes = version11.maxMemoryAllocationSize,
          .memoryBytes = description.kind == DeviceKind::cpu ? 0 : description.memoryBytes,
          .secondCacheBytes = secondCacheBytes(),
          .maxSharedBytes = limits.maxComputeSharedMemorySize,
          .maxGroupInvocations = limits.maxComputeWorkGroupInvocations,
          .shaderInt64 = features.features.shaderInt64 && features12.shaderSubgroupExtendedTypes,
          .laneCode = llvmpipeTraits(description.driver).laneCode,
          .bufferAddresses = description.kind == DeviceKind::cpu && features12.bufferDeviceAddress};
}

}  // namespace xrds
