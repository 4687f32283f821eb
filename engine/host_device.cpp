#include "engine/host_device.h"

#include <algorithm>

#include "engine/drivers/matrix_units.h"
#include "engine/drivers/selection.h"
#include "engine/drivers/traits.h"
#include "engine/handles.h"
#include "engine/kernel_family.h"
#include "xrds/error.h"

namespace xrds {
namespace {

// One whose functions are there.
std::unique_ptr<Instance> loadedInstance(const HostDevice& host) {
  auto instance = takeInstance(host.instance, host.loader);
  if (!vkEnumeratePhysicalDevices || !vkGetPhysicalDeviceProperties2)
    throw InvalidArgument(
        "The Vulkan loader that was given does not know the instance, or it was not made for Vulkan 1.2: set the "
        "apiVersion of its VkApplicationInfo.");
  return instance;
}

std::unique_ptr<Instance> checkedInstance(const HostDevice& host) {
  if (!host.instance || !host.physicalDevice)
    throw InvalidArgument("The Vulkan instance or the physical device is a null handle.");
  auto instance = loadedInstance(host);
  const auto devices = physicalDevices(host.instance);
  if (std::find(devices.begin(), devices.end(), host.physicalDevice) == devices.end())
    throw InvalidArgument("The physical device is none of the instance's.");
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(host.physicalDevice, &properties);
  if (properties.apiVersion < VK_API_VERSION_1_2)
    throw InvalidArgument(std::string(properties.deviceName) +
                          " is older than Vulkan 1.2; update its driver or choose another device.");
  return instance;
}

// The ways to matrix units that the program has enabled, or could.
MatrixUnits unitsOf(const HostFeatures& features) {
  if (!features.shaderFloat16 || !features.vulkanMemoryModel || !features.computeFullSubgroups)
    return MatrixUnits::none;
  if (features.cooperativeMatrixNv) return MatrixUnits::nv;
  return features.cooperativeMatrixKhr ? MatrixUnits::khr : MatrixUnits::none;
}

// The bits of its timestamps that count.
uint32_t checkedQueue(const HostDevice& host) {
  if (!host.device || !host.queue) throw InvalidArgument("The Vulkan device or its queue is a null handle.");
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(host.physicalDevice, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(host.physicalDevice, &count, families.data());
  if (host.queueFamily >= count || !(families[host.queueFamily].queueFlags & VK_QUEUE_COMPUTE_BIT))
    throw InvalidArgument("Queue family " + std::to_string(host.queueFamily) +
                          " of the device has no compute queues: give a queue of one that has.");
  return families[host.queueFamily].timestampValidBits;
}

}  // namespace

VkPhysicalDevice selectPhysicalDevice(const HostDevice& host, std::string_view select) {
  const auto held = holdLoader();
  const auto instance = loadedInstance(host);
  const auto found = findDevices(*instance);
  std::vector<DeviceDescription> descriptions;
  descriptions.reserve(found.size());
  for (const FoundDevice& each : found) descriptions.push_back(each.description);
  return found[selectDevice(descriptions, select)].physicalDevice;
}

HostFeatures usefulFeatures(const HostDevice& host) {
  const auto held = holdLoader();
  const auto instance = checkedInstance(host);
  const DeviceDescription description = describe(*instance, host.physicalDevice);
  const bool areChosen = subgroupControl(host.physicalDevice).areChosen;
  const DeviceTraits traits = traitsOf(host.physicalDevice, description, description.kernelFamily, areChosen);
  HostFeatures useful{.shaderInt64 = traits.shaderInt64};
  if (extensionsOf(traits.matrixUnits).empty()) return useful;
  useful.subgroupSizeControl = areChosen;
  useful.computeFullSubgroups = useful.shaderFloat16 = useful.vulkanMemoryModel = true;
  useful.cooperativeMatrixKhr = traits.matrixUnits == MatrixUnits::khr;
  useful.cooperativeMatrixNv = traits.matrixUnits == MatrixUnits::nv;
  return useful;
}

std::vector<const char*> extensionsOf(const HostFeatures& features) { return extensionsOf(unitsOf(features)); }

Buffer hostBuffer(Gpu& gpu, VkBuffer buffer, uint64_t byteSize) {
  Gpu::Handles& device = gpu.handles();
  VkMemoryRequirements found;
  device.vk.vkGetBufferMemoryRequirements(device.device, buffer, &found);
  if (found.size < byteSize)
    throw InvalidArgument("A buffer of at most " + std::to_string(found.size) + " bytes was given, expected at least " +
                          std::to_string(byteSize) + " from its begin to the last pixel.");
  auto handles = std::make_unique<Buffer::Handles>(device);
  handles->isHosts = true;
  handles->buffer = buffer;
  handles->byteSize = handles->askedByteSize = byteSize;
  return Buffer(std::move(handles));
}

void takeDevice(Gpu::Handles& gpu, const HostDevice& host) {
  gpu.isShared = true;
  gpu.instance = checkedInstance(host);
  gpu.timestampValidBits = checkedQueue(host);
  gpu.physicalDevice = host.physicalDevice;
  gpu.description = describe(*gpu.instance, host.physicalDevice);
  checkDriver(gpu.description);
  if (unitsOf(host.enabled) != gpu.description.matrixUnits) gpu.description.matrixUnits = MatrixUnits::none;
  gpu.description.kernelFamily = suitableFamily(gpu.description);
  gpu.queueFamily = host.queueFamily;
  gpu.lockQueue = host.lockQueue;
  gpu.unlockQueue = host.unlockQueue;
  gpu.queue = host.queue;
  gpu.device = host.device;
  volkLoadDeviceTable(&gpu.vk, gpu.device);
}

}  // namespace xrds
