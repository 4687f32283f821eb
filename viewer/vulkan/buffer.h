#pragma once

#include <cstddef>
#include <span>

#include "viewer/vulkan/device.h"

namespace xrds {

/// Memory of the device that kernels, drawings and copies use.
class DeviceBuffer {
 public:
  /// Bytes behind the last one that may be bound with it, so that a part may begin at an aligned offset before its own.
  static constexpr uint64_t kSpareBytes = 256;

  /// Throws OutOfMemory if the device has not that much memory. It must outlive the buffer.
  DeviceBuffer(VulkanDevice& device, uint64_t byteSize);
  ~DeviceBuffer();
  DeviceBuffer(const DeviceBuffer&) = delete;
  DeviceBuffer& operator=(const DeviceBuffer&) = delete;

  VkBuffer buffer() const { return buffer_; }
  uint64_t byteSize() const { return byteSize_; }
  /// Copy host bytes in and out, from an offset on; wait for the end.
  void upload(uint64_t byteOffset, std::span<const std::byte> bytes);
  void download(uint64_t byteOffset, std::span<std::byte> bytes) const;
  void clear();

 private:
  VulkanDevice& device_;
  uint64_t byteSize_;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  std::byte* mapped_ = nullptr;  // null if the host does not see it
};

/// Memory of the host that the device copies from and into: pixels under the cursor, screenshots.
class HostBuffer {
 public:
  /// Throws OutOfMemory.
  HostBuffer(VulkanDevice& device, uint64_t byteSize);
  ~HostBuffer();
  HostBuffer(const HostBuffer&) = delete;
  HostBuffer& operator=(const HostBuffer&) = delete;

  VkBuffer buffer() const { return buffer_; }
  /// Valid once the copy is known to be finished.
  std::span<std::byte> bytes() const { return {mapped_, byteSize_}; }

 private:
  VulkanDevice& device_;
  uint64_t byteSize_;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  std::byte* mapped_ = nullptr;
};

}  // namespace xrds
