#include "xrds/alpha.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace xrds {
namespace {

// Weights that sum to one do so only up to rounding, yet what is opaque must stay opaque.
float snapped(float alpha) {
  constexpr float kRounding = 1e-5F;
  if (std::abs(alpha - 1) < kRounding) return 1;
  return std::abs(alpha) < kRounding ? 0 : std::clamp(alpha, 0.F, 1.F);
}

}  // namespace

AlphaUpscaler::AlphaUpscaler(Device& device, uint32_t width, uint32_t height, uint32_t scale, const TileOptions& tiles)
    : width_(width),
      height_(height),
      model_(Model::untrained(scale, "bicubic", "none")),
      upscaler_(device, model_, width, height, {.exposure = 1.F, .tiles = tiles}) {}

std::vector<float> AlphaUpscaler::run(std::span<const float> alpha, const Upscaler::Progress& progress) {
  if (alpha.size() != size_t{width_} * height_)
    throw InvalidArgument("An alpha of " + std::to_string(alpha.size()) + " pixels was given, expected " +
                          std::to_string(width_) + " x " + std::to_string(height_) + ".");
  std::vector<float> spread(3 * alpha.size());
  for (size_t i = 0; i < spread.size(); ++i) spread[i] = alpha[i / 3];
  std::vector<float> upscaled(spread.size() * model_.scale() * model_.scale());
  if (!upscaler_.run({spread.data(), width_, height_}, {}, upscaled, progress)) return {};
  std::vector<float> result(upscaled.size() / 3);
  for (size_t i = 0; i < result.size(); ++i) result[i] = snapped(upscaled[3 * i]);
  return result;
}

}  // namespace xrds
