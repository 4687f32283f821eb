#pragma once

#include <vulkan/vulkan.h>

#include <optional>
#include <string>
#include <vector>

#include "xrds/xrds_vulkan.h"

// Every function of a device that the library or the host of the tests calls.
// clang-format off
#define XRDS_DEVICE_FUNCTIONS(X) \
  X(vkAllocateCommandBuffers) X(vkAllocateDescriptorSets) X(vkAllocateMemory) X(vkBeginCommandBuffer) \
  X(vkBindBufferMemory) X(vkBindImageMemory) X(vkCmdBindDescriptorSets) X(vkCmdBindPipeline) X(vkCmdCopyBuffer) \
  X(vkCmdCopyBufferToImage) X(vkCmdCopyImageToBuffer) X(vkCmdDispatch) X(vkCmdExecuteCommands) X(vkCmdFillBuffer) \
  X(vkCmdPipelineBarrier) X(vkCmdPushConstants) X(vkCmdResetQueryPool) X(vkCmdWriteTimestamp) X(vkCreateBuffer) \
  X(vkCreateBufferView) X(vkCreateCommandPool) X(vkCreateComputePipelines) X(vkCreateDescriptorPool) \
  X(vkCreateDescriptorSetLayout) X(vkCreateFence) X(vkCreateImage) X(vkCreatePipelineCache) \
  X(vkCreatePipelineLayout) X(vkCreateQueryPool) X(vkCreateSemaphore) X(vkCreateShaderModule) X(vkDestroyBuffer) \
  X(vkDestroyBufferView) X(vkDestroyCommandPool) X(vkDestroyDescriptorPool) X(vkDestroyDescriptorSetLayout) \
  X(vkDestroyDevice) X(vkDestroyFence) X(vkDestroyImage) X(vkDestroyPipeline) X(vkDestroyPipelineCache) \
  X(vkDestroyPipelineLayout) X(vkDestroyQueryPool) X(vkDestroySemaphore) X(vkDestroyShaderModule) \
  X(vkDeviceWaitIdle) X(vkEndCommandBuffer) X(vkFreeMemory) X(vkGetBufferMemoryRequirements) X(vkGetDeviceQueue) \
  X(vkGetImageMemoryRequirements) X(vkGetMemoryFdKHR) X(vkGetPipelineCacheData) X(vkGetQueryPoolResults) \
  X(vkGetSemaphoreCounterValue) X(vkGetSemaphoreFdKHR) X(vkImportSemaphoreFdKHR) X(vkMapMemory) X(vkQueueSubmit) \
  X(vkResetFences) X(vkSignalSemaphore) X(vkUpdateDescriptorSets) X(vkWaitForFences) X(vkWaitSemaphores)
// clang-format on

namespace xrds::test {

/// The functions of a device.
struct DeviceFunctions {
#define XRDS_MEMBER(name) PFN_##name name = nullptr;
  XRDS_DEVICE_FUNCTIONS(XRDS_MEMBER)
#undef XRDS_MEMBER
};

/// A buffer that the host of the tests sees.
struct HostBuffer {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  std::byte* bytes = nullptr;
};

/// An image of the host, and its memory.
struct HostPicture2d {
  VkImage image = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
};

/// A program with a Vulkan device of its own, opened with validation unless XRDS_TEST_NO_VALIDATION is set, as xrds is
/// embedded in it. The device's functions that it hands out are counted; those of which the tests know nothing are
/// missing.
class VulkanHost {
 public:
  /// Throws std::runtime_error without a device.
  VulkanHost();
  ~VulkanHost();
  VulkanHost(const VulkanHost&) = delete;
  VulkanHost& operator=(const VulkanHost&) = delete;

  /// What xrds gets of it.
  XrdsVulkanDevice vulkan() const;
  static PFN_vkGetInstanceProcAddr loader();
  /// Without the counting.
  static PFN_vkGetInstanceProcAddr systemLoader();
  /// Calls of the library since the last time, by name: those that were made.
  static std::vector<std::pair<std::string, int>> takeCalls();

  /// What the validation layer has said, of any host; of what was not destroyed when a host is.
  static std::vector<std::string>& messages();
  /// Lets the library's calls of a function fail, from the next one on; nullptr: none.
  static void fail(const char* function, VkResult result);
  /// Lets the library have so many bytes of memory beside those that it has, and no more; none: as many as there are.
  static void limitMemory(std::optional<uint64_t> more);

  HostBuffer buffer(uint64_t byteSize, VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                                                  VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                                                  VK_BUFFER_USAGE_TRANSFER_DST_BIT);
  /// A buffer whose memory another device may import by the file descriptor; -1: the device cannot.
  HostBuffer exported(uint64_t byteSize, int& descriptor);
  /// The same memory, of a device of the same GPU. Takes the descriptor.
  HostBuffer imported(uint64_t byteSize, int descriptor);
  HostPicture2d image(uint32_t width, uint32_t height, VkFormat format, VkImageUsageFlags usage);
  void transition(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to);
  /// Between an image and a buffer of its pixels, the former in the layout for it.
  void copy(VkCommandBuffer commands, VkBuffer buffer, VkImage image, uint32_t width, uint32_t height, bool toImage);
  VkSemaphore timeline();
  /// Whether the device exports and imports timelines, and signals of its queue, by file descriptor.
  bool sharesTimelines() const { return sharesTimelines_; }
  bool sharesSignals() const { return sharesSignals_; }
  /// A timeline that another device of the GPU may import by the file descriptor, which that takes.
  VkSemaphore exportedTimeline(int& descriptor);
  VkSemaphore importedTimeline(int descriptor);
  /// A signal of the queue behind what was submitted, and behind `behind` if that has a semaphore; another device takes
  /// the descriptor, and signals a timeline of its own as soon as the signal has come.
  int exportSignal(XrdsTimelinePoint behind = {});
  void importSignal(int descriptor, XrdsTimelinePoint signal);
  void signal(XrdsTimelinePoint point) { submitBetween({}, point); }  // by the queue
  void await(XrdsTimelinePoint point);
  VkCommandBuffer begin();
  void end(VkCommandBuffer commands);
  void submit(VkCommandBuffer commands);
  void await();

  DeviceFunctions vk;  // not counted
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  uint32_t queueFamily = 0;
  XrdsVulkanFeatures features{};

 private:
  void openInstance();
  void openDevice();
  std::vector<const char*> sharingExtensions();
  bool shares(VkSemaphoreType kind, VkExternalSemaphoreHandleTypeFlagBits handle) const;
  VkSemaphore semaphore(VkSemaphoreType kind, VkExternalSemaphoreHandleTypeFlags handles = 0);
  int exportedFrom(VkSemaphore from, VkExternalSemaphoreHandleTypeFlagBits handle);
  void import(VkSemaphore to, VkExternalSemaphoreHandleTypeFlagBits handle, VkSemaphoreImportFlags flags,
              int descriptor);
  void submitBetween(XrdsTimelinePoint wait, XrdsTimelinePoint signal);
  VkDeviceMemory allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted, const void* next = nullptr);
  HostBuffer bufferIn(uint64_t byteSize, VkBufferUsageFlags usage, const void* memoryOf, bool isExternal);

  bool sharesMemory_ = false, sharesTimelines_ = false, sharesSignals_ = false;  // by file descriptor
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::vector<HostBuffer> buffers_;
  std::vector<HostPicture2d> images_;
  std::vector<VkSemaphore> semaphores_;
};

}  // namespace xrds::test
