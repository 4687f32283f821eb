#pragma once

#include <volk.h>

#include <cstddef>
#include <span>

#include "engine/handles.h"

namespace xrds {

/// Memory of the host that the device copies into: pixels under the cursor, screenshots.
class HostBuffer {
 public:
  /// Throws Error if Vulkan fails.
  HostBuffer(Gpu::Handles& gpu, uint64_t byteSize);
  ~HostBuffer();
  HostBuffer(const HostBuffer&) = delete;
  HostBuffer& operator=(const HostBuffer&) = delete;

  VkBuffer buffer() const { return buffer_; }
  /// Valid once the copy is known to be finished.
  std::span<const std::byte> bytes() const { return {mapped_, byteSize_}; }

 private:
  Gpu::Handles& gpu_;
  uint64_t byteSize_;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  const std::byte* mapped_ = nullptr;
};

}  // namespace xrds
