#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "xrds/upscaler.h"

namespace xrds {

/// An alpha so near to 0 or 1 is that.
inline constexpr float kAlphaRounding = 1e-5F;

/// An interpolated alpha in [0, 1]: weights that sum to one do so only up to rounding, yet what is opaque must stay
/// opaque.
inline float snappedAlpha(float alpha) {
  if (std::abs(alpha - 1) < kAlphaRounding) return 1;
  return std::abs(alpha) < kAlphaRounding ? 0 : std::clamp(alpha, 0.F, 1.F);
}

/// Upscales the alpha of frames of one size, which the network does not see: bicubic, what is 0 or 1 all around stays
/// exactly that.
class AlphaUpscaler {
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

inline AlphaUpscaler::AlphaUpscaler(Device& device, uint32_t width, uint32_t height, uint32_t scale,
                                    const TileOptions& tiles)
    : width_(width),
      height_(height),
      model_(Model::untrained(scale, "bicubic", "none")),
      upscaler_(device, model_, width, height, {.exposure = 1.F, .tiles = tiles}) {}

inline std::vector<float> AlphaUpscaler::run(std::span<const float> alpha, const Upscaler::Progress& progress) {
  if (alpha.size() != size_t{width_} * height_)
    throw InvalidArgument("An alpha of " + std::to_string(alpha.size()) + " pixels was given, expected " +
                          std::to_string(width_) + " x " + std::to_string(height_) + ".");
  std::vector<float> spread(3 * alpha.size());
  for (size_t i = 0; i < spread.size(); ++i) spread[i] = alpha[i / 3];
  std::vector<float> upscaled(spread.size() * model_.scale() * model_.scale());
  if (!upscaler_.run({spread.data(), width_, height_}, {}, upscaled, progress)) return {};
  std::vector<float> result(upscaled.size() / 3);
  for (size_t i = 0; i < result.size(); ++i) result[i] = snappedAlpha(upscaled[3 * i]);
  return result;
}

}  // namespace xrds
