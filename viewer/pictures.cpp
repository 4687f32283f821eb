#include "viewer/pictures.h"

#include "engine/vulkan_result.h"

namespace xrds {

Pictures::~Pictures() {
  const Gpu::Handles& gpu = gpu_.handles();
  for (const Picture& made : pictures_) gpu.vk.vkDestroyBufferView(gpu.device, made.view.texels, nullptr);
}

Pictures::Picture Pictures::make(uint32_t width, uint32_t height, uint32_t channels) {
  Picture made;
  made.memory = std::make_unique<Buffer>(gpu_, uint64_t{4} * width * height * channels);
  made.view = {made.memory->handles().buffer, VK_NULL_HANDLE, width, height, channels, false};
  VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
  info.buffer = made.view.buffer;
  info.format = VK_FORMAT_R32G32B32A32_SFLOAT;
  info.range = uint64_t{4} * width * height * channels;
  const Gpu::Handles& gpu = gpu_.handles();
  checkResult(gpu.vk.vkCreateBufferView(gpu.device, &info, nullptr, &made.view.texels), "vkCreateBufferView");
  return made;
}

void Pictures::replace(Slot slot, Picture fresh) {
  {
    const std::lock_guard lock(mutex_);
    std::swap(picture(slot), fresh);
  }
  if (!fresh.memory) return;
  Gpu::Handles& gpu = gpu_.handles();
  {
    const std::lock_guard lock(gpu.queueAccess);
    checkResult(gpu.vk.vkQueueWaitIdle(gpu.queue), "vkQueueWaitIdle");  // a drawing may still read the old one
  }
  gpu.vk.vkDestroyBufferView(gpu.device, fresh.view.texels, nullptr);
}

void Pictures::resize(Slot slot, uint32_t width, uint32_t height, uint32_t channels) {
  const PictureView now = at(slot);
  if (now.width != width || now.height != height || now.channels != channels)
    replace(slot, make(width, height, channels));
}

void Pictures::copy(std::span<const PictureSource> sources) {
  Gpu::Handles& gpu = gpu_.handles();
  runOnce(gpu, [&](VkCommandBuffer commands) {
    for (const PictureSource& source : sources) {
      const PictureView to = at(source.slot);
      const VkBufferCopy region{source.byteOffset, 0, uint64_t{4} * to.width * to.height * to.channels};
      gpu.vk.vkCmdCopyBuffer(commands, source.buffer, to.buffer, 1, &region);
    }
  });
  const std::lock_guard lock(mutex_);
  for (const PictureSource& source : sources) picture(source.slot).view.valid = true;
}

void Pictures::upload(Slot slot, uint32_t width, uint32_t height, uint32_t channels, std::span<const float> pixels) {
  Picture fresh = make(width, height, channels);
  fresh.memory->upload(0, std::as_bytes(pixels));
  fresh.view.valid = true;
  replace(slot, std::move(fresh));
}

void Pictures::invalidate(Slot slot) {
  const std::lock_guard lock(mutex_);
  picture(slot).view.valid = false;
}

uint64_t Pictures::byteSize() const {
  uint64_t sum = 0;
  for (const Picture& made : pictures_)
    if (made.memory) sum += made.memory->byteSize();
  return sum;
}

}  // namespace xrds
