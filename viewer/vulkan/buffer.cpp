#include "viewer/vulkan/buffer.h"

#include <algorithm>
#include <cstring>

namespace xrds {
namespace {

constexpr uint64_t kPieceBytes = uint64_t{64} << 20;  // of a copy that the host does not make itself
constexpr VkMemoryPropertyFlags kHostSees = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

VkBuffer makeBuffer(VulkanDevice& device, uint64_t byteSize, VkBufferUsageFlags usage) {
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = byteSize;
  info.usage = usage;
  VkBuffer buffer = VK_NULL_HANDLE;
  checkVulkan(vkCreateBuffer(device.device, &info, nullptr, &buffer), "vkCreateBuffer");
  return buffer;
}

// Binds memory of the first of the kinds that there is, and maps it if the host sees it. The last kind is there always.
VkDeviceMemory bindMemory(VulkanDevice& device, VkBuffer buffer, std::initializer_list<VkMemoryPropertyFlags> kinds,
                          std::byte*& mapped) {
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device.device, buffer, &needs);
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  info.allocationSize = needs.size;
  info.memoryTypeIndex = device.memory.memoryTypeCount;
  for (const VkMemoryPropertyFlags kind : kinds)
    if (info.memoryTypeIndex == device.memory.memoryTypeCount)
      info.memoryTypeIndex = device.memoryType(needs.memoryTypeBits, kind);
  VkDeviceMemory memory = VK_NULL_HANDLE;
  checkVulkan(vkAllocateMemory(device.device, &info, nullptr, &memory), "vkAllocateMemory");
  checkVulkan(vkBindBufferMemory(device.device, buffer, memory, 0), "vkBindBufferMemory");
  if ((device.memory.memoryTypes[info.memoryTypeIndex].propertyFlags & kHostSees) != kHostSees) return memory;
  void* bytes = nullptr;
  checkVulkan(vkMapMemory(device.device, memory, 0, VK_WHOLE_SIZE, 0, &bytes), "vkMapMemory");
  mapped = static_cast<std::byte*>(bytes);
  return memory;
}

void copy(VulkanDevice& device, VkBuffer from, VkBuffer to, const VkBufferCopy& region) {
  device.runOnce([&](VkCommandBuffer commands) { vkCmdCopyBuffer(commands, from, to, 1, &region); });
}

// Calls `piece` for parts of so many bytes, with their offset and size.
template <class Piece>
void inPieces(uint64_t byteSize, const Piece& piece) {
  for (uint64_t begin = 0; begin < byteSize; begin += kPieceBytes)
    piece(begin, std::min(kPieceBytes, byteSize - begin));
}

}  // namespace

DeviceBuffer::DeviceBuffer(VulkanDevice& device, uint64_t byteSize)
    : device_(device),
      byteSize_(byteSize),
      buffer_(makeBuffer(device, byteSize + kSpareBytes,
                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                             VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT)) {
  try {
    constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    // A device that is the host, or shares its memory, needs no copies.
    const bool shares = device.properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
    memory_ = bindMemory(device, buffer_, {shares ? kLocal | kHostSees : kLocal, kLocal, 0}, mapped_);
  } catch (...) {
    vkDestroyBuffer(device.device, buffer_, nullptr);
    throw;
  }
}

DeviceBuffer::~DeviceBuffer() {
  vkDestroyBuffer(device_.device, buffer_, nullptr);
  vkFreeMemory(device_.device, memory_, nullptr);
}

void DeviceBuffer::upload(uint64_t byteOffset, std::span<const std::byte> bytes) {
  if (mapped_) {
    std::memcpy(mapped_ + byteOffset, bytes.data(), bytes.size());
    return;
  }
  const HostBuffer staging(device_, std::min<uint64_t>(kPieceBytes, bytes.size()));
  inPieces(bytes.size(), [&](uint64_t begin, uint64_t size) {
    std::memcpy(staging.bytes().data(), bytes.data() + begin, size);
    copy(device_, staging.buffer(), buffer_, {0, byteOffset + begin, size});
  });
}

void DeviceBuffer::download(uint64_t byteOffset, std::span<std::byte> bytes) const {
  if (mapped_) {
    std::memcpy(bytes.data(), mapped_ + byteOffset, bytes.size());
    return;
  }
  const HostBuffer staging(device_, std::min<uint64_t>(kPieceBytes, bytes.size()));
  inPieces(bytes.size(), [&](uint64_t begin, uint64_t size) {
    copy(device_, buffer_, staging.buffer(), {byteOffset + begin, 0, size});
    std::memcpy(bytes.data() + begin, staging.bytes().data(), size);
  });
}

void DeviceBuffer::clear() {
  device_.runOnce([&](VkCommandBuffer commands) { vkCmdFillBuffer(commands, buffer_, 0, VK_WHOLE_SIZE, 0); });
}

HostBuffer::HostBuffer(VulkanDevice& device, uint64_t byteSize)
    : device_(device),
      byteSize_(byteSize),
      buffer_(makeBuffer(device, byteSize, VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT)) {
  try {
    memory_ = bindMemory(device, buffer_, {kHostSees | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, kHostSees}, mapped_);
  } catch (...) {
    vkDestroyBuffer(device.device, buffer_, nullptr);
    throw;
  }
}

HostBuffer::~HostBuffer() {
  vkDestroyBuffer(device_.device, buffer_, nullptr);
  vkFreeMemory(device_.device, memory_, nullptr);
}

}  // namespace xrds
