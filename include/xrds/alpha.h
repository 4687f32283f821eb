#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "xrds/upscaler.h"

namespace xrds {

/// Upscales the alpha of frames of one size, which the network does not see: bicubic, what is 0 or 1 all around stays
/// exactly that.
class XRDS_API AlphaUpscaler {
 public:
  /// width x height: of the low-resolution alpha. The device must outlive it. Throws as Upscaler does.
  AlphaUpscaler(Device& device, uint32_t width, uint32_t height, uint32_t scale, const TileOptions& tiles = {});

  /// One number a pixel [height, width] -> [scale height, scale width], in [0, 1]; empty if `progress` cancelled it.
  /// Throws Error if the size does not fit or the device fails.
  std::vector<float> run(std::span<const float> alpha, const Upscaler::Progress& progress = {});

 private:
  uint32_t width_, height_;
  Model model_;
  Upscaler upscaler_;
};

}  // namespace xrds
