#pragma once

#include <volk.h>

#include <memory>
#include <mutex>
#include <vector>

#include "engine/device.h"

namespace xrds {

/// A Vulkan 1.2 instance, with the validation layer and its messenger if asked for. It may be another program's.
struct Instance {
  VkInstance instance = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  PFN_vkDestroyInstance destroy = nullptr;  // null: whose it is destroys it
  PFN_vkDestroyDebugUtilsMessengerEXT destroyMessenger = nullptr;
  std::function<void(std::string_view)> onMessage;

  Instance() = default;
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
};

/// volk keeps its functions in globals, of the loader that was taken last. Who calls them holds this.
std::unique_lock<std::recursive_mutex> holdLoader();

/// Takes another program's instance, with the loader that made it (null: the system's).
std::unique_ptr<Instance> takeInstance(VkInstance instance, PFN_vkGetInstanceProcAddr loader);

/// Throws Error if there is no Vulkan loader or the layer or an extension is missing. Returns null if the loader knows
/// no driver.
std::unique_ptr<Instance> openInstance(const DeviceOptions& options);

/// A device that can run the engine, and how it describes itself.
struct FoundDevice {
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  DeviceDescription description;
};

DeviceDescription describe(const Instance& instance, VkPhysicalDevice device);

/// Every physical device of the instance.
std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance);

/// Every device of Vulkan 1.2 or later with a compute queue.
std::vector<FoundDevice> findDevices(const Instance& instance);

/// Whether the device lists the extension.
bool hasDeviceExtension(VkPhysicalDevice device, const char* name);

}  // namespace xrds
