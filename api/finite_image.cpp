#include "api/finite_image.h"

#include <cmath>

#include "frames/frame_input.h"
#include "image/repair.h"

namespace xrds {

Image imageOf(const PixelView& view) {
  Image image;
  image.width = static_cast<int>(view.width);
  image.height = static_cast<int>(view.height);
  image.channels = 3;
  image.pixels = packed(view);
  return image;
}

FiniteImage::FiniteImage(const PixelView& given, uint64_t& repaired) : view_(given) {
  const size_t pixels = size_t{given.width} * given.height;
  const auto isFinite = [&](size_t p) {
    const float* rgb = given.pixels + p * given.stride;
    return std::isfinite(rgb[0]) && std::isfinite(rgb[1]) && std::isfinite(rgb[2]);
  };
  size_t p = 0;
  while (p < pixels && isFinite(p)) ++p;
  if (p == pixels) return;
  copy_ = imageOf(given);
  repaired += repairNonFinite(copy_).nonFinitePixels;
  view_ = {copy_.pixels.data(), given.width, given.height};
}

}  // namespace xrds
