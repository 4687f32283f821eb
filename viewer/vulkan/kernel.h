#pragma once

#include <vector>

#include "viewer/vulkan/buffer.h"

namespace xrds {

/// A compute program with its buffers: those that it reads as texels are its first bindings, then two storage buffers,
/// of which each run sees the same part.
class Kernel {
 public:
  struct Texels {
    const DeviceBuffer* buffer;
    VkFormat format;
  };
  /// partBytes: of the storage buffers that a run sees, from the offset on that it is given, spare bytes among them.
  /// Throws Error if Vulkan fails. All must outlive the kernel.
  Kernel(VulkanDevice& device, std::span<const uint32_t> program, std::span<const Texels> texels,
         const DeviceBuffer& first, const DeviceBuffer& second, uint64_t partBytes, uint32_t pushBytes);
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  /// Runs columns x rows work groups and waits for their end. byteOffset: of the part, a multiple of 256.
  void run(std::span<const std::byte> push, uint32_t byteOffset, uint32_t columns, uint32_t rows);

 private:
  void makeLayout(uint32_t texelCount, uint32_t pushBytes);
  void makePipeline(std::span<const uint32_t> program);
  void makeSet(std::span<const Texels> texels, const DeviceBuffer& first, const DeviceBuffer& second,
               uint64_t partBytes);
  void release();

  VulkanDevice& device_;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  std::vector<VkBufferView> views_;
};

/// A view of the whole buffer as texels.
VkBufferView makeTexelView(VulkanDevice& device, const DeviceBuffer& buffer, VkFormat format);
VkShaderModule makeModule(VulkanDevice& device, std::span<const uint32_t> program);

}  // namespace xrds
