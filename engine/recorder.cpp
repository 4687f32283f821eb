#include "engine/recorder.h"

#include <algorithm>
#include <cstring>

#include "engine/drivers/vulkan_result.h"
#include "engine/hazards.h"
#include "engine/host_device.h"
#include "engine/work.h"

namespace xrds {
namespace {

ByteRange resolve(ByteRange range, BindingKind kind) {
  if (range.image) {
    XRDS_CHECK(kind == BindingKind::copied && range.byteSize > 0);
    return range;
  }
  XRDS_CHECK(range.buffer != nullptr);
  XRDS_CHECK_EQ(range.byteOffset % (kind == BindingKind::copied ? 4 : kBindingAlignment), 0u);
  XRDS_CHECK_LT(range.byteOffset, range.buffer->byteSize());
  const uint64_t rest = range.buffer->byteSize() - range.byteOffset;
  if (range.byteSize == 0) range.byteSize = rest;
  XRDS_CHECK_LE(range.byteSize, rest);
  return range;
}

void checkBinding(const Gpu::Handles& gpu, const Binding& binding, const ByteRange& range) {
  if (binding.kind == BindingKind::copied) return;
  if (binding.kind == BindingKind::storage) {
    XRDS_CHECK_EQ(range.byteSize % 4, 0u);
    XRDS_CHECK_LE(range.byteSize, uint64_t{gpu.limits.maxStorageBufferRange});
    return;
  }
  const uint64_t texelBytes = 4 * byteSize(binding.type);
  XRDS_CHECK_EQ(range.byteSize % texelBytes, 0u);
  XRDS_CHECK_LE(range.byteSize / texelBytes, uint64_t{gpu.limits.maxTexelBufferElements});
  XRDS_CHECK(binding.access == Access::read);
}

void checkLimits(const Gpu::Handles& gpu, const PlacedDispatch& placed) {
  const Dispatch& dispatch = placed.dispatch;
  XRDS_CHECK_LE(dispatch.pushConstants.size(), size_t{kMaxPushConstantBytes});
  XRDS_CHECK_EQ(dispatch.pushConstants.size() % 4, 0u);
  for (size_t axis = 0; axis < 3; ++axis) {
    XRDS_CHECK_LT(0u, dispatch.groupCount[axis]);
    XRDS_CHECK_LE(dispatch.groupCount[axis], gpu.limits.maxComputeWorkGroupCount[axis]);
  }
  for (size_t i = 0; i < placed.ranges.size(); ++i) checkBinding(gpu, dispatch.bindings[i], placed.ranges[i]);
  if (!dispatch.isCopy()) return;
  XRDS_CHECK_EQ(placed.ranges.size(), 2u);
  XRDS_CHECK(dispatch.bindings[1].kind == BindingKind::copied && dispatch.bindings[1].access == Access::write);
  XRDS_CHECK_EQ(placed.ranges[0].byteSize, placed.ranges[1].byteSize);
}

// The texels of a range, and as many more as llvmpipe needs to take it for the same as all others (kVariantTexels).
uint64_t texelsOfOneVariant(uint64_t texels) {
  return alignUp(std::max(texels, kVariantTexels) - kVariantTexels, kVariantStep) + kVariantTexels;
}

void keepToOneVariant(const Gpu::Handles& gpu, PlacedDispatch& placed) {
  for (size_t i = 0; i < placed.ranges.size(); ++i) {
    const Binding& binding = placed.dispatch.bindings[i];
    const uint64_t texelBytes = 4 * byteSize(binding.type);
    const uint64_t texels = texelsOfOneVariant(placed.ranges[i].byteSize / texelBytes);
    if (isTexelBuffer(binding.kind) && texels <= gpu.limits.maxTexelBufferElements)
      placed.ranges[i].byteSize = texels * texelBytes;
  }
}

std::vector<RangeAccess> accessesOf(const PlacedDispatch& placed) {
  std::vector<RangeAccess> accesses;
  for (size_t i = 0; i < placed.ranges.size(); ++i) {
    const ByteRange& range = placed.ranges[i];
    const auto touched = range.image ? (uint64_t)(range.image->image) : (uint64_t)(range.buffer->handles().buffer);
    accesses.push_back({.buffer = touched,
                        .byteOffset = range.byteOffset,
                        .byteSize = range.byteSize,
                        .access = placed.dispatch.bindings[i].access});
  }
  return accesses;
}

void pushWeightsAddress(PlacedDispatch& placed) {
  if (!placed.dispatch.weightsByAddress) return;
  const auto weights = std::ranges::find(placed.dispatch.bindings, kWeights, &Binding::value);
  XRDS_CHECK(weights != placed.dispatch.bindings.end());
  const ByteRange& range = placed.ranges[weights - placed.dispatch.bindings.begin()];
  const uint64_t begin = range.buffer->handles().address, address = begin + range.byteOffset;
  XRDS_CHECK_LT(0u, begin);
  auto& bytes = placed.dispatch.pushConstants;
  XRDS_CHECK_LE(sizeof address, bytes.size());
  std::memcpy(bytes.data() + bytes.size() - sizeof address, &address, sizeof address);
}

uint64_t workOf(const PlacedDispatch& placed) {
  uint64_t written = 0;
  for (size_t i = 0; i < placed.ranges.size(); ++i)
    if (placed.dispatch.bindings[i].access == Access::write) written += placed.ranges[i].byteSize;
  return xrds::workOf(placed.dispatch.multiplyAdds, written);
}

}  // namespace

std::vector<WorkPiece> cutWork(std::span<const PlacedDispatch> dispatches, uint64_t mostWork) {
  std::vector<WorkPiece> pieces;
  uint64_t held = 0;
  for (size_t i = 0; i < dispatches.size(); ++i) {
    const uint64_t work = workOf(dispatches[i]);
    if (pieces.empty() || held + work > mostWork) {
      pieces.push_back({.begin = i});
      held = 0;
    }
    held += work;
    pieces.back().work = held;
    pieces.back().end = i + 1;
  }
  return pieces;
}

Recorder::Recorder(Gpu& gpu, std::span<const PlacedDispatch> asked)
    : gpu_(gpu.handles()), dispatches_(asked.begin(), asked.end()) {
  XRDS_CHECK_LT(0u, asked.size());
  std::vector<std::vector<RangeAccess>> accesses;
  for (PlacedDispatch& placed : dispatches_) {
    XRDS_CHECK_EQ(placed.ranges.size(), placed.dispatch.bindings.size());
    for (size_t i = 0; i < placed.ranges.size(); ++i)
      placed.ranges[i] = resolve(placed.ranges[i], placed.dispatch.bindings[i].kind);
    checkLimits(gpu_, placed);
    pushWeightsAddress(placed);
    if (gpu.description().kind == DeviceKind::cpu) keepToOneVariant(gpu_, placed);
    accesses.push_back(accessesOf(placed));
  }
  barriers_ = barriersBefore(accesses);
  std::vector<const Dispatch*> launches;
  launches.reserve(dispatches_.size());
  for (const PlacedDispatch& placed : dispatches_) launches.push_back(&placed.dispatch);
  compilePrograms(gpu, launches);
  try {
    makePool();
    for (const PlacedDispatch& placed : dispatches_)
      sets_.push_back(placed.dispatch.isCopy() ? VK_NULL_HANDLE : describe(placed));
  } catch (...) {
    release();
    throw;
  }
}

Recorder::~Recorder() { release(); }

void Recorder::release() {
  if (gpu_.abandoned) return;
  for (const auto& [key, view] : views_) gpu_.vk.vkDestroyBufferView(gpu_.device, view, nullptr);
  gpu_.vk.vkDestroyDescriptorPool(gpu_.device, pool_, nullptr);
}

void Recorder::makePool() {
  uint32_t storages = 0, texels = 0;
  for (const auto& placed : dispatches_)
    for (const Binding& binding : placed.dispatch.bindings) {
      storages += binding.kind == BindingKind::storage;
      texels += isTexelBuffer(binding.kind);
    }
  // One more of each, because a pool of zero is not allowed.
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, storages + 1},
                                        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, texels + 1}};
  VkDescriptorPoolCreateInfo descriptors{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  descriptors.maxSets = static_cast<uint32_t>(dispatches_.size());
  descriptors.poolSizeCount = 2;
  descriptors.pPoolSizes = sizes;
  checkResult(gpu_.vk.vkCreateDescriptorPool(gpu_.device, &descriptors, nullptr, &pool_), "vkCreateDescriptorPool");
}

VkBufferView Recorder::viewOf(const ByteRange& range, VkFormat format) {
  const VkBuffer buffer = range.buffer->handles().buffer;
  VkBufferView& view = views_[{buffer, range.byteOffset, range.byteSize, format}];
  if (view) return view;
  VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
  info.buffer = buffer;
  info.format = format;
  info.offset = range.byteOffset;
  info.range = range.byteSize;
  checkResult(gpu_.vk.vkCreateBufferView(gpu_.device, &info, nullptr, &view), "vkCreateBufferView");
  return view;
}

VkDescriptorSet Recorder::describe(const PlacedDispatch& placed) {
  const VkDescriptorSet set = allocateSet(gpu_, pool_, gpu_.pipelines.at(PipelineKey(placed.dispatch)).setLayout);
  const size_t count = placed.ranges.size();
  std::vector<VkDescriptorBufferInfo> buffers(count);
  std::vector<VkBufferView> texels(count);
  std::vector<VkWriteDescriptorSet> writes(count, {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET});
  for (size_t i = 0; i < count; ++i) {
    const ByteRange& range = placed.ranges[i];
    const Binding& binding = placed.dispatch.bindings[i];
    writes[i].dstSet = set;
    writes[i].dstBinding = static_cast<uint32_t>(i);
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = descriptorTypeOf(binding.kind);
    if (isTexelBuffer(binding.kind)) {
      texels[i] = viewOf(range, texelFormatOf(binding.type, binding.kind));
      writes[i].pTexelBufferView = &texels[i];
    } else {
      buffers[i] = {range.buffer->handles().buffer, range.byteOffset, range.byteSize};
      writes[i].pBufferInfo = &buffers[i];
    }
  }
  gpu_.vk.vkUpdateDescriptorSets(gpu_.device, static_cast<uint32_t>(count), writes.data(), 0, nullptr);
  return set;
}

void Recorder::barrierBetween(VkCommandBuffer commands) const {
  constexpr VkPipelineStageFlags stages = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT |
                          VK_ACCESS_TRANSFER_WRITE_BIT;
  gpu_.vk.vkCmdPipelineBarrier(commands, stages, stages, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

// The image in that layout, from `from`, for its copy or behind it.
void Recorder::moveLayout(VkCommandBuffer commands, const HostImage& image, VkImageLayout from,
                          VkImageLayout to) const {
  if (from == to) return;
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.srcAccessMask = barrier.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  gpu_.vk.vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr,
                               0, nullptr, 1, &barrier);
}

void Recorder::recordImageCopy(VkCommandBuffer commands, const ByteRange& from, const ByteRange& to) const {
  const HostImage& image = from.image ? *from.image : *to.image;
  const VkImageLayout copying =
      from.image ? VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL : VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  VkBufferImageCopy region{};
  region.bufferOffset = from.image ? to.byteOffset : from.byteOffset;
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {image.width, image.height, 1};
  moveLayout(commands, image, image.layout, copying);
  if (from.image)
    gpu_.vk.vkCmdCopyImageToBuffer(commands, image.image, copying, to.buffer->handles().buffer, 1, &region);
  else
    gpu_.vk.vkCmdCopyBufferToImage(commands, from.buffer->handles().buffer, image.image, copying, 1, &region);
  moveLayout(commands, image, copying, image.layout);
}

void Recorder::recordCopy(VkCommandBuffer commands, const PlacedDispatch& placed) const {
  const ByteRange &from = placed.ranges[0], &to = placed.ranges[1];
  if (from.image || to.image) return recordImageCopy(commands, from, to);
  const VkBufferCopy region{from.byteOffset, to.byteOffset, from.byteSize};
  gpu_.vk.vkCmdCopyBuffer(commands, from.buffer->handles().buffer, to.buffer->handles().buffer, 1, &region);
}

void Recorder::record(VkCommandBuffer commands, size_t begin, size_t end,
                      const std::function<void(VkPipelineStageFlagBits)>& stamp) const {
  for (size_t i = begin; i < end; ++i) {
    // Dispatches that overlap would have each other's time.
    if ((barriers_[i] || stamp) && i > begin) barrierBetween(commands);
    const Dispatch& dispatch = dispatches_[i].dispatch;
    if (dispatch.isCopy())
      recordCopy(commands, dispatches_[i]);
    else
      recordDispatch(gpu_, commands, dispatch, sets_[i], dispatch.groupCount);
    if (stamp) stamp(dispatch.isCopy() ? VK_PIPELINE_STAGE_TRANSFER_BIT : VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT);
  }
}

}  // namespace xrds
