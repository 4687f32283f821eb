#include "engine/buffer.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "engine/drivers/vulkan_result.h"
#include "engine/handles.h"
#include "engine/parallel.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint64_t kStagingBytes = uint64_t{16} << 20;
constexpr uint64_t kBytesOfThread = uint64_t{256} << 10;  // fewer are copied sooner than a thread starts

constexpr VkMemoryPropertyFlags kHostAccess =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

std::string mebibytes(uint64_t byteSize) { return std::to_string((byteSize + (1u << 20) - 1) >> 20) + " MiB"; }

// The first memory type, of those allowed, that has the wanted properties; -1 if none has.
int findMemoryType(const Gpu::Handles& gpu, uint32_t allowed, VkMemoryPropertyFlags wanted) {
  for (uint32_t i = 0; i < gpu.memory.memoryTypeCount; ++i)
    if ((allowed >> i & 1) && (gpu.memory.memoryTypes[i].propertyFlags & wanted) == wanted) return static_cast<int>(i);
  return -1;
}

// Memory that is local to the device and that the host reads at full speed, if there is such; else for a device
// buffer memory that is only the device's, and for a staging buffer the host's.
uint32_t chooseMemoryType(const Gpu::Handles& gpu, uint32_t allowed, bool forStaging) {
  const VkMemoryPropertyFlags hostCached = kHostAccess | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  const VkMemoryPropertyFlags local = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
  std::vector<VkMemoryPropertyFlags> preferences{local | hostCached, local, 0};
  if (forStaging) preferences = {hostCached, kHostAccess};
  if (gpu.options.forceStaging && !forStaging) preferences = {local, 0};
  for (const VkMemoryPropertyFlags wanted : preferences)
    if (const int type = findMemoryType(gpu, allowed, wanted); type >= 0) return static_cast<uint32_t>(type);
  throw Error("The Vulkan device offers no memory for buffers; update its driver.");
}

void allocate(Buffer::Handles& buffer, bool forStaging) {
  Gpu::Handles& gpu = buffer.gpu;
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = buffer.byteSize;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  if (gpu.traits.bufferAddresses) info.usage |= VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
  if (buffer.byteSize > gpu.maxAllocationBytes)
    throw OutOfMemory("A buffer of " + mebibytes(buffer.askedByteSize) + " is needed, but " + gpu.description.name +
                      " allows at most " + mebibytes(gpu.maxAllocationBytes) +
                      " at once; use smaller tiles or images.");
  checkResult(gpu.vk.vkCreateBuffer(gpu.device, &info, nullptr, &buffer.buffer), "vkCreateBuffer");

  VkMemoryRequirements needs;
  gpu.vk.vkGetBufferMemoryRequirements(gpu.device, buffer.buffer, &needs);
  const uint32_t type = chooseMemoryType(gpu, needs.memoryTypeBits, forStaging);
  const uint64_t heapBytes = gpu.memory.memoryHeaps[gpu.memory.memoryTypes[type].heapIndex].size;
  VkMemoryAllocateFlagsInfo flags{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO};
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  if (gpu.traits.bufferAddresses) allocation.pNext = &flags;
  allocation.allocationSize = needs.size;
  allocation.memoryTypeIndex = type;
  const VkResult result = needs.size > heapBytes
                              ? VK_ERROR_OUT_OF_DEVICE_MEMORY
                              : gpu.vk.vkAllocateMemory(gpu.device, &allocation, nullptr, &buffer.memory);
  if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
    throw OutOfMemory(gpu.description.name + " has no room for a buffer of " + mebibytes(needs.size) +
                      " in its memory of " + mebibytes(heapBytes) +
                      "; use smaller tiles or images, or close other programs.");
  checkResult(result, "vkAllocateMemory");
  checkResult(gpu.vk.vkBindBufferMemory(gpu.device, buffer.buffer, buffer.memory, 0), "vkBindBufferMemory");
  if (gpu.traits.bufferAddresses) {
    VkBufferDeviceAddressInfo asked{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO};
    asked.buffer = buffer.buffer;
    buffer.address = gpu.vk.vkGetBufferDeviceAddress(gpu.device, &asked);
  }

  const VkMemoryPropertyFlags has = gpu.memory.memoryTypes[type].propertyFlags;
  const bool hostReadsIt = (has & kHostAccess) == kHostAccess && (has & VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  if (!forStaging && (gpu.options.forceStaging || !hostReadsIt)) return;
  void* mapped = nullptr;
  checkResult(gpu.vk.vkMapMemory(gpu.device, buffer.memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
  buffer.mapped = static_cast<std::byte*>(mapped);
}

// A multiple of kBindingAlignment with kSpareBytes behind what was asked for, and no power of two: llvmpipe (Mesa 22.3)
// compiles every program that reads texels anew for buffers of 2^n bytes.
uint64_t allocatedByteSize(uint64_t asked) {
  const uint64_t needed = alignUp(asked, kBindingAlignment) + kSpareBytes;
  return std::has_single_bit(needed) ? needed + kBindingAlignment : needed;
}

std::unique_ptr<Buffer::Handles> makeBuffer(Gpu::Handles& gpu, uint64_t byteSize, bool forStaging) {
  XRDS_CHECK_LT(0u, byteSize);
  auto made = std::make_unique<Buffer::Handles>(gpu);
  made->askedByteSize = byteSize;
  made->byteSize = allocatedByteSize(byteSize);
  allocate(*made, forStaging);
  return made;
}

const Buffer::Handles& stagingOf(Gpu::Handles& gpu) {
  if (!gpu.staging) gpu.staging = makeBuffer(gpu, kStagingBytes, true);
  return *gpu.staging;
}

void copy(Gpu::Handles& gpu, VkBuffer from, uint64_t fromOffset, VkBuffer to, uint64_t toOffset, uint64_t byteSize) {
  runOnce(gpu, [&](VkCommandBuffer commands) {
    const VkBufferCopy region{fromOffset, toOffset, byteSize};
    gpu.vk.vkCmdCopyBuffer(commands, from, to, 1, &region);
  });
}

void checkRange(const Buffer::Handles& buffer, uint64_t byteOffset, uint64_t byteSize) {
  XRDS_CHECK_LE(byteOffset, buffer.askedByteSize);
  XRDS_CHECK_LE(byteSize, buffer.askedByteSize - byteOffset);
}

// Calls take(row) for each of them, on several threads where the bytes are many.
void eachRow(uint64_t rowCount, uint64_t rowBytes, const std::function<void(uint64_t row)>& take) {
  inParallel(rowCount, kBytesOfThread / std::max<uint64_t>(rowBytes, 1), [&](uint64_t row, uint64_t end) {
    for (; row < end; ++row) take(row);
  });
}

void copyBytes(const std::byte* from, std::byte* to, uint64_t byteSize) {
  inParallel(byteSize, kBytesOfThread,
             [&](uint64_t begin, uint64_t end) { std::memcpy(to + begin, from + begin, end - begin); });
}

// Rows of that many bytes in one staging copy.
uint32_t rowsAtOnce(uint64_t rowBytes) {
  XRDS_CHECK_LT(0u, rowBytes);
  XRDS_CHECK_LE(rowBytes, kStagingBytes);
  return static_cast<uint32_t>(kStagingBytes / rowBytes);
}

}  // namespace

Buffer::Handles::~Handles() {
  if (gpu.abandoned || isHosts) return;
  gpu.vk.vkDestroyBuffer(gpu.device, buffer, nullptr);
  gpu.vk.vkFreeMemory(gpu.device, memory, nullptr);
}

Buffer::Buffer(Gpu& gpu, uint64_t byteSize) : handles_(makeBuffer(gpu.handles(), byteSize, false)) {}
Buffer::Buffer(std::unique_ptr<Handles> handles) : handles_(std::move(handles)) {}
Buffer::~Buffer() = default;
Buffer::Buffer(Buffer&&) noexcept = default;
Buffer& Buffer::operator=(Buffer&&) noexcept = default;

uint64_t Buffer::byteSize() const { return handles_->askedByteSize; }

void Buffer::upload(uint64_t byteOffset, std::span<const std::byte> bytes) {
  checkRange(*handles_, byteOffset, bytes.size());
  if (handles_->mapped) {
    copyBytes(bytes.data(), handles_->mapped + byteOffset, bytes.size());
    return;
  }
  const Handles& staging = stagingOf(handles_->gpu);
  for (size_t done = 0; done < bytes.size(); done += kStagingBytes) {
    const auto part = bytes.subspan(done, std::min<size_t>(kStagingBytes, bytes.size() - done));
    copyBytes(part.data(), staging.mapped, part.size());
    copy(handles_->gpu, staging.buffer, 0, handles_->buffer, byteOffset + done, part.size());
  }
}

void Buffer::download(uint64_t byteOffset, std::span<std::byte> bytes) const {
  checkRange(*handles_, byteOffset, bytes.size());
  if (handles_->mapped) {
    copyBytes(handles_->mapped + byteOffset, bytes.data(), bytes.size());
    return;
  }
  const Handles& staging = stagingOf(handles_->gpu);
  for (size_t done = 0; done < bytes.size(); done += kStagingBytes) {
    const auto part = bytes.subspan(done, std::min<size_t>(kStagingBytes, bytes.size() - done));
    copy(handles_->gpu, handles_->buffer, byteOffset + done, staging.buffer, 0, part.size());
    copyBytes(staging.mapped, part.data(), part.size());
  }
}

void Buffer::uploadRows(uint64_t byteOffset, uint64_t rowBytes, uint32_t rowCount,
                        const std::function<void(uint32_t, std::span<std::byte>)>& write) {
  checkRange(*handles_, byteOffset, rowBytes * rowCount);
  const auto each = [&](std::byte* to, uint32_t first, uint32_t end) {
    eachRow(end - first, rowBytes, [&](uint64_t row) {
      write(first + static_cast<uint32_t>(row), {to + row * rowBytes, rowBytes});
    });
  };
  if (handles_->mapped) return each(handles_->mapped + byteOffset, 0, rowCount);
  const Handles& staging = stagingOf(handles_->gpu);
  const uint32_t most = rowsAtOnce(rowBytes);
  for (uint32_t row = 0; row < rowCount; row += most) {
    const uint32_t end = std::min(rowCount, row + most);
    each(staging.mapped, row, end);
    copy(handles_->gpu, staging.buffer, 0, handles_->buffer, byteOffset + row * rowBytes, (end - row) * rowBytes);
  }
}

void Buffer::downloadRows(uint64_t byteOffset, uint64_t rowBytes, uint32_t rowCount,
                          const std::function<void(uint32_t, std::span<const std::byte>)>& read) const {
  checkRange(*handles_, byteOffset, rowBytes * rowCount);
  const auto each = [&](const std::byte* from, uint32_t first, uint32_t end) {
    eachRow(end - first, rowBytes, [&](uint64_t row) {
      read(first + static_cast<uint32_t>(row), {from + row * rowBytes, rowBytes});
    });
  };
  if (handles_->mapped) return each(handles_->mapped + byteOffset, 0, rowCount);
  const Handles& staging = stagingOf(handles_->gpu);
  const uint32_t most = rowsAtOnce(rowBytes);
  for (uint32_t row = 0; row < rowCount; row += most) {
    const uint32_t end = std::min(rowCount, row + most);
    copy(handles_->gpu, handles_->buffer, byteOffset + row * rowBytes, staging.buffer, 0, (end - row) * rowBytes);
    each(staging.mapped, row, end);
  }
}

void Buffer::fill(uint32_t pattern) {
  runOnce(handles_->gpu, [this, pattern](VkCommandBuffer commands) {
    handles_->gpu.vk.vkCmdFillBuffer(commands, handles_->buffer, 0, VK_WHOLE_SIZE, pattern);
  });
}

}  // namespace xrds
