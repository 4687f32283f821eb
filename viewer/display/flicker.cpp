#include "viewer/display/flicker.h"

#include <algorithm>

#include "flicker_comp.h"
#include "viewer/display/flicker_parameters.h"

namespace xrds {
namespace {

uint64_t byteSizeOf(uint32_t width, uint32_t height) { return uint64_t{16} * width * height; }

}  // namespace

Flicker::Flicker(VulkanDevice& device, uint32_t width, uint32_t height)
    : device_(device),
      width_(width),
      height_(height),
      latest_(device, byteSizeOf(width, height)),
      state_(device, byteSizeOf(width, height)),
      deviation_(device, byteSizeOf(width, height)) {
  const Kernel::Texels texels{&latest_, VK_FORMAT_R32G32B32A32_SFLOAT};
  kernel_.emplace(device, flicker_comp, std::span(&texels, 1), state_, deviation_, byteSizeOf(width, height),
                  static_cast<uint32_t>(sizeof(shader::FlickerParameters)));
  state_.clear();
}

void Flicker::add(Pictures& pictures) {
  device_.runOnce([&](VkCommandBuffer commands) {
    const VkBufferCopy region{0, 0, latest_.byteSize()};
    vkCmdCopyBuffer(commands, pictures.at(Slot::output).buffer, latest_.buffer(), 1, &region);
  });
  count_ = std::min(count_ + 1, shader::kFlickerFrames);
  const shader::FlickerParameters parameters{width_, height_, 1.F / static_cast<float>(count_)};
  const auto groups = [](uint32_t pixels) { return (pixels + shader::kFlickerGroup - 1) / shader::kFlickerGroup; };
  kernel_->run(std::as_bytes(std::span(&parameters, 1)), 0, groups(width_), groups(height_));
  if (count_ < 2) return;
  pictures.resize(Slot::flicker, width_, height_, 1);
  const PictureSource source{Slot::flicker, &deviation_};
  pictures.copy({&source, 1});
}

}  // namespace xrds
