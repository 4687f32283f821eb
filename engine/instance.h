#pragma once

#include <volk.h>

#include <memory>
#include <vector>

#include "engine/device.h"

namespace xrds {

/// A Vulkan 1.2 instance, with the validation layer and its messenger if asked for.
struct Instance {
  VkInstance instance = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  std::function<void(std::string_view)> onMessage;

  Instance() = default;
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
};

/// Throws Error if there is no Vulkan loader or the layer or an extension is missing. Returns null if the loader knows
/// no driver.
std::unique_ptr<Instance> openInstance(const DeviceOptions& options);

/// A device that can run the engine, and how it describes itself.
struct FoundDevice {
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  DeviceDescription description;
};

/// Every device of Vulkan 1.2 or later with a compute queue.
std::vector<FoundDevice> findDevices(const Instance& instance);

/// Whether the device lists the extension.
bool hasDeviceExtension(VkPhysicalDevice device, const char* name);

}  // namespace xrds
