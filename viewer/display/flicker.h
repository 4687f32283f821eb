#pragma once

#include <optional>

#include "viewer/pictures.h"
#include "viewer/vulkan/kernel.h"

namespace xrds {

/// How much the output changes from picture to picture: the standard deviation of each pixel's sRGB values, the root
/// mean square of the three, over the last shader::kFlickerFrames pictures, older ones fading out. Where things move it
/// shows that as well. Used by one thread.
class Flicker {
 public:
  /// For pictures of that size. Throws Error if the device cannot hold it.
  Flicker(VulkanDevice& device, uint32_t width, uint32_t height);

  bool fits(const PictureView& output) const { return output.width == width_ && output.height == height_; }
  /// Takes the output in and, from the second on, renews the picture of the deviation.
  void add(Pictures& pictures);

 private:
  VulkanDevice& device_;
  uint32_t width_, height_;
  DeviceBuffer latest_, state_, deviation_;
  std::optional<Kernel> kernel_;
  uint32_t count_ = 0;
};

}  // namespace xrds
