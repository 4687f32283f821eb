#include "viewer/host_buffer.h"

#include "engine/vulkan_result.h"
#include "xrds/error.h"

namespace xrds {

HostBuffer::HostBuffer(Gpu::Handles& gpu, uint64_t byteSize) : gpu_(gpu), byteSize_(byteSize) {
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = byteSize;
  info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  checkResult(gpu.vk.vkCreateBuffer(gpu.device, &info, nullptr, &buffer_), "vkCreateBuffer");
  VkMemoryRequirements needs;
  gpu.vk.vkGetBufferMemoryRequirements(gpu.device, buffer_, &needs);
  // Every device has a type that is both and fits any buffer.
  constexpr VkMemoryPropertyFlags kWanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocation.allocationSize = needs.size;
  for (uint32_t i = 0; i < gpu.memory.memoryTypeCount; ++i)
    if ((needs.memoryTypeBits >> i & 1) && (gpu.memory.memoryTypes[i].propertyFlags & kWanted) == kWanted)
      allocation.memoryTypeIndex = i;
  checkResult(gpu.vk.vkAllocateMemory(gpu.device, &allocation, nullptr, &memory_), "vkAllocateMemory");
  checkResult(gpu.vk.vkBindBufferMemory(gpu.device, buffer_, memory_, 0), "vkBindBufferMemory");
  void* mapped = nullptr;
  checkResult(gpu.vk.vkMapMemory(gpu.device, memory_, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
  mapped_ = static_cast<const std::byte*>(mapped);
}

HostBuffer::~HostBuffer() {
  gpu_.vk.vkDestroyBuffer(gpu_.device, buffer_, nullptr);
  gpu_.vk.vkFreeMemory(gpu_.device, memory_, nullptr);
}

}  // namespace xrds
