/* A Vulkan device of the program, shared with the library. */
/* NOLINTBEGIN(modernize-*,readability-identifier-naming): C. */
#ifndef XRDS_C_VULKAN_DEVICE_H
#define XRDS_C_VULKAN_DEVICE_H

#include <vulkan/vulkan_core.h>

#include "xrds/c/device.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Call it before the first instance of the process is made, while no other thread reads the environment: sets the
 * variables with which Mesa's driver for CPUs (lavapipe) takes the widest vectors that are fast and keeps what it has
 * compiled in the cache folder. What the user has set stays. cacheFolder: NULL: the user's cache folder. draws: 1 if
 * the program draws triangles, too; then the width stays that of the driver, since old versions crash with others. Of
 * other drivers nothing changes. */
XRDS_API XrdsResult xrdsPrepareVulkan(const char* cacheFolder, int draws);

/* The device of the instance that xrdsOpenDevice() would open for XrdsDeviceOptions.select. Fails, naming those there
 * are, if none of Vulkan 1.2 with a compute queue fits or several do. */
XRDS_API XrdsResult xrdsSelectVulkanDevice(PFN_vkGetInstanceProcAddr loader, VkInstance instance, const char* select,
                                           VkPhysicalDevice* physicalDevice);

/* Features of Vulkan under their names there, 1 each: what would speed up the kernels, or what is enabled. None is
 * needed: slower kernels do without. The extensions are those that the features belong to. */
typedef struct XrdsVulkanFeatures {
  uint32_t structSize;
  int32_t shaderInt64, shaderSubgroupExtendedTypes, shaderFloat16, vulkanMemoryModel;
  int32_t subgroupSizeControl, computeFullSubgroups; /* VK_EXT_subgroup_size_control */
  int32_t cooperativeMatrixKhr, cooperativeMatrixNv; /* VK_KHR_cooperative_matrix, VK_NV_cooperative_matrix */
  const char* const* extensions;                     /* of the library's own, valid as long as the program runs */
  uint32_t extensionCount;
} XrdsVulkanFeatures;

/* What to enable with vkCreateDevice. loader: the program's vkGetInstanceProcAddr; NULL: the system's. The caller sets
 * features->structSize. Instance and device must be of Vulkan 1.2 or later. */
XRDS_API XrdsResult xrdsGetVulkanFeatures(PFN_vkGetInstanceProcAddr loader, VkInstance instance,
                                          VkPhysicalDevice physicalDevice, XrdsVulkanFeatures* features);

typedef struct XrdsVulkanDevice {
  uint32_t structSize;
  uint32_t queueFamily;             /* with compute */
  PFN_vkGetInstanceProcAddr loader; /* default NULL: the system's */
  VkInstance instance;
  VkPhysicalDevice physicalDevice;
  VkDevice device;
  VkQueue queue;
  const XrdsVulkanFeatures* enabled; /* what is enabled of the device; default NULL: nothing. Extensions do not count */
  /* Called around each use of the queue. Default NULL: the program does not use it during calls of this library but
   * xrdsRecord(). */
  void (*lockQueue)(void* user);
  void (*unlockQueue)(void* user);
  void* queueUser;
} XrdsVulkanDevice;

/* Shares the program's device, which must outlive the handle and what is made on it. options may be NULL; its `select`
 * must be. Everything of xrds.h works on it; kernels are tuned with XRDS_TUNE_NOW alone. */
XRDS_API XrdsResult xrdsOpenVulkanDevice(const XrdsVulkanDevice* vulkan, const XrdsDeviceOptions* options,
                                         XrdsDevice** device);

#ifdef __cplusplus
}
#endif
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
