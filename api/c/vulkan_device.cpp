// Shares a device of the caller's.
#include "api/c/handles.h"
#include "api/c/result.h"
#include "api/c/sized.h"
#include "engine/host_device.h"
#include "xrds/xrds_vulkan.h"

using namespace xrds::c;

namespace {

xrds::HostFeatures featuresOf(const XrdsVulkanFeatures& given) {
  return {.shaderInt64 = given.shaderInt64 && given.shaderSubgroupExtendedTypes,
          .subgroupSizeControl = given.subgroupSizeControl != 0,
          .computeFullSubgroups = given.computeFullSubgroups != 0,
          .shaderFloat16 = given.shaderFloat16 != 0,
          .vulkanMemoryModel = given.vulkanMemoryModel != 0,
          .cooperativeMatrixKhr = given.cooperativeMatrixKhr != 0,
          .cooperativeMatrixNv = given.cooperativeMatrixNv != 0};
}

xrds::HostDevice hostOf(const XrdsVulkanDevice& given) {
  xrds::HostDevice host{.loader = given.loader,
                        .instance = given.instance,
                        .physicalDevice = given.physicalDevice,
                        .device = given.device,
                        .queueFamily = given.queueFamily,
                        .queue = given.queue};
  if (given.enabled) host.enabled = featuresOf(taken(*given.enabled));
  if ((given.lockQueue == nullptr) != (given.unlockQueue == nullptr))
    throw xrds::InvalidArgument("Of lockQueue and unlockQueue one is a null pointer: give both or neither.");
  if (given.lockQueue) {
    host.lockQueue = [lock = given.lockQueue, user = given.queueUser] { lock(user); };
    host.unlockQueue = [unlock = given.unlockQueue, user = given.queueUser] { unlock(user); };
  }
  return host;
}

// The names last as long as the program, and so does the list of each combination that was asked for.
const std::vector<const char*>& extensionNames(const xrds::HostFeatures& features) {
  static const std::vector<const char*> kNone,
      kKhr = xrds::extensionsOf({.computeFullSubgroups = true,
                                 .shaderFloat16 = true,
                                 .vulkanMemoryModel = true,
                                 .cooperativeMatrixKhr = true}),
      kNv = xrds::extensionsOf({.computeFullSubgroups = true,
                                .shaderFloat16 = true,
                                .vulkanMemoryModel = true,
                                .cooperativeMatrixNv = true});
  return features.cooperativeMatrixKhr ? kKhr : features.cooperativeMatrixNv ? kNv : kNone;
}

}  // namespace

XrdsResult xrdsPrepareVulkan(const char* cacheFolder, int draws) {
  return guarded([&] {
    xrds::prepareDrivers(pathOf(cacheFolder), draws != 0);
    return XRDS_OK;
  });
}

XrdsResult xrdsSelectVulkanDevice(PFN_vkGetInstanceProcAddr loader, VkInstance instance, const char* select,
                                  VkPhysicalDevice* physicalDevice) {
  return guarded([&] {
    VkPhysicalDevice& out = required(physicalDevice, "physicalDevice");
    required(instance, "instance");
    out = xrds::selectPhysicalDevice({.loader = loader, .instance = instance}, textOf(select));
    return XRDS_OK;
  });
}

XrdsResult xrdsGetVulkanFeatures(PFN_vkGetInstanceProcAddr loader, VkInstance instance, VkPhysicalDevice physicalDevice,
                                 XrdsVulkanFeatures* features) {
  return guarded([&] {
    XrdsVulkanFeatures& out = required(features, "features");
    checkedSize(out);
    const xrds::HostFeatures useful =
        xrds::usefulFeatures({.loader = loader, .instance = instance, .physicalDevice = physicalDevice});
    const auto& extensions = extensionNames(useful);
    give<XrdsVulkanFeatures>({.structSize = sizeof out,
                              .shaderInt64 = useful.shaderInt64,
                              .shaderSubgroupExtendedTypes = useful.shaderInt64,
                              .shaderFloat16 = useful.shaderFloat16,
                              .vulkanMemoryModel = useful.vulkanMemoryModel,
                              .subgroupSizeControl = useful.subgroupSizeControl,
                              .computeFullSubgroups = useful.computeFullSubgroups,
                              .cooperativeMatrixKhr = useful.cooperativeMatrixKhr,
                              .cooperativeMatrixNv = useful.cooperativeMatrixNv,
                              .extensions = extensions.data(),
                              .extensionCount = static_cast<uint32_t>(extensions.size())},
                             out);
    return XRDS_OK;
  });
}

XrdsResult xrdsOpenVulkanDevice(const XrdsVulkanDevice* vulkan, const XrdsDeviceOptions* options, XrdsDevice** device) {
  return guarded([&] {
    XrdsDevice*& out = required(device, "device");
    const xrds::HostDevice host = hostOf(taken(required(vulkan, "vulkan")));
    const XrdsDeviceOptions usual = xrdsDeviceOptionsDefault(), given = options ? taken(*options, usual) : usual;
    out = Devices::open().add(
        std::make_shared<XrdsDevice>(xrds::openGpu(optionsOf(given), host), given.preparation, given.preparationUser));
    return XRDS_OK;
  });
}
