#include "viewer/pictures.h"

#include <algorithm>

#include "viewer/vulkan/kernel.h"

namespace xrds {

Pictures::~Pictures() {
  for (const Picture& made : pictures_) vkDestroyBufferView(gpu_.device, made.view.texels, nullptr);
}

Pictures::Picture Pictures::make(uint32_t width, uint32_t height, uint32_t planes) {
  Picture made;
  made.view = {VK_NULL_HANDLE, VK_NULL_HANDLE, width, height, planes, false};
  made.memory = std::make_unique<DeviceBuffer>(gpu_, made.view.byteSize());
  made.view.buffer = made.memory->buffer();
  made.view.texels = makeTexelView(gpu_, *made.memory, VK_FORMAT_R32G32B32A32_SFLOAT);
  return made;
}

void Pictures::replace(Slot slot, Picture fresh) {
  {
    const std::lock_guard lock(mutex_);
    std::swap(picture(slot), fresh);
  }
  if (!fresh.memory) return;
  {
    const std::lock_guard lock(gpu_.queueAccess);
    checkVulkan(vkQueueWaitIdle(gpu_.queue), "vkQueueWaitIdle");  // a drawing may still read the old one
  }
  vkDestroyBufferView(gpu_.device, fresh.view.texels, nullptr);
}

void Pictures::resize(Slot slot, uint32_t width, uint32_t height, uint32_t planes) {
  const PictureView now = at(slot);
  if (now.width != width || now.height != height || now.planes != planes) replace(slot, make(width, height, planes));
}

void Pictures::copy(std::span<const PictureSource> sources) {
  gpu_.runOnce([&](VkCommandBuffer commands) {
    for (const PictureSource& source : sources) {
      const PictureView to = at(source.slot);
      const VkBufferCopy region{0, 0, to.byteSize()};
      vkCmdCopyBuffer(commands, source.buffer->buffer(), to.buffer, 1, &region);
    }
  });
  const std::lock_guard lock(mutex_);
  for (const PictureSource& source : sources) picture(source.slot).view.valid = true;
}

void Pictures::upload(Slot slot, uint32_t width, uint32_t height, uint32_t planes, std::span<const float> pixels) {
  Picture fresh = make(width, height, planes);
  fresh.memory->upload(0, std::as_bytes(pixels));
  fresh.view.valid = true;
  replace(slot, std::move(fresh));
}

void Pictures::upload(Slot slot, const Image& image) {
  std::vector<float> pixels(image.pixelCount() * 4);
  for (size_t p = 0; p < image.pixelCount(); ++p)
    std::copy_n(&image.pixels[p * static_cast<size_t>(image.channels)], 3, &pixels[4 * p]);
  upload(slot, static_cast<uint32_t>(image.width), static_cast<uint32_t>(image.height), 1, pixels);
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
