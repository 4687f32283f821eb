#include "cli/alpha.h"

#include <algorithm>
#include <cmath>

#include "cli/report.h"

namespace xrds {
namespace {

// Weights that sum to one do so only up to rounding, yet what is opaque must stay opaque.
float snapped(float alpha) {
  constexpr float kRounding = 1e-5F;
  if (std::abs(alpha - 1) < kRounding) return 1;
  return std::abs(alpha) < kRounding ? 0 : std::clamp(alpha, 0.F, 1.F);
}

}  // namespace

Image upscaleAlpha(Device& device, const Image& alpha, int scale, const TileOptions& tiles) {
  Image spread(alpha.width, alpha.height, 3);
  for (size_t p = 0; p < alpha.pixelCount(); ++p)
    std::fill_n(&spread.pixels[3 * p], 3, alpha.pixels[p * alpha.channels]);
  const Image upscaled = runBaseline(device, {"bicubic", "none", 1.F, tiles}, spread, {}, scale);
  Image result(upscaled.width, upscaled.height, 1);
  for (size_t p = 0; p < result.pixelCount(); ++p) result.pixels[p] = snapped(upscaled.pixels[3 * p]);
  return result;
}

Image withAlpha(const Image& colour, const Image& alpha) {
  Image joined(colour.width, colour.height, 4);
  for (size_t p = 0; p < joined.pixelCount(); ++p) {
    std::copy_n(&colour.pixels[3 * p], 3, &joined.pixels[4 * p]);
    joined.pixels[4 * p + 3] = alpha.pixels[p];
  }
  return joined;
}

}  // namespace xrds
