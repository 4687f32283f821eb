#pragma once

#include <vulkan/vulkan.h>

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "xrds/xrds_vulkan.hpp"

namespace xrds {

struct VulkanOptions {
  std::string select{};  // as Device::Options
  bool validation = false;
  std::function<void(std::string_view)> onMessage{};  // of the validation layers; must live as long as the device
  std::vector<std::string> instanceExtensions{};      // of the desktop; empty: nothing is drawn
};

/// The Vulkan device of the viewer: it traces and draws, and xrds shares it. What uses the queue locks `queueAccess`
/// meanwhile.
class VulkanDevice {
 public:
  /// Throws Error if no device fits, or it cannot draw on the desktop.
  explicit VulkanDevice(VulkanOptions options);
  ~VulkanDevice();
  VulkanDevice(const VulkanDevice&) = delete;
  VulkanDevice& operator=(const VulkanDevice&) = delete;

  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  uint32_t queueFamily = 0;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::mutex queueAccess;

  bool isCpu() const { return properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
  /// As xrds shares it; this must outlive what is returned.
  Device shared();
  /// Gives commands to the queue.
  void submit(const VkSubmitInfo& info, VkFence fence);
  /// Records commands, submits them and waits for their end, with everything ordered before and after them.
  void runOnce(const std::function<void(VkCommandBuffer)>& record);
  /// A type of memory with all the properties; the number of types if there is none.
  uint32_t memoryType(uint32_t allowed, VkMemoryPropertyFlags wanted) const;

 private:
  void openInstance();
  void openDevice();
  void makeCommandObjects();
  void release();

  VulkanOptions options_;
  XrdsVulkanFeatures features_{};
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::mutex onceAccess_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence finished_ = VK_NULL_HANDLE;
};

/// Throws Error naming the call and its result unless that is VK_SUCCESS; OutOfMemory or DeviceLost where it is that.
void checkVulkan(VkResult result, const char* call);

}  // namespace xrds
