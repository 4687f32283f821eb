#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "xrds/error.h"
#include "xrds/pixel_view.h"

namespace xrds {

/// How an image is mirrored: first on its diagonal, so that rows become columns, then left to right and upside down,
/// both of which are half a turn.
struct Mirror {
  bool leftRight = false, upsideDown = false, transposed = false;
};

/// The mirrors of an ensemble of 1, 2, 4 or 8 passes, those on the diagonal first, the image as it is last. Throws
/// Error for other counts.
inline std::span<const Mirror> mirrorsOf(uint32_t passes) {
  if (passes != 1 && passes != 2 && passes != 4 && passes != 8)
    throw InvalidArgument("An ensemble of " + std::to_string(passes) + " passes was asked for, expected 1, 2, 4 or 8.");
  static constexpr Mirror kMirrors[] = {
      {true, false, true}, {false, true, true}, {true, true, true}, {false, false, true},
      {true, false},       {false, true},       {true, true},       {}};
  return std::span(kMirrors).last(passes);
}

/// A pixel of a mirrored image of that size, row by row from 0, in the image as it is.
inline uint64_t mirroredPixel(uint64_t pixel, uint32_t width, uint32_t height, Mirror mirror) {
  const uint64_t x = mirror.leftRight ? width - 1 - pixel % width : pixel % width;
  const uint64_t y = mirror.upsideDown ? height - 1 - pixel / width : pixel / width;
  return mirror.transposed ? x * height + y : y * width + x;
}

/// The mirrored image, three floats a pixel. The components of a normal turn along: x points right, y up.
inline std::vector<float> mirrored(const PixelView& image, Mirror mirror, bool isNormal) {
  const uint32_t width = mirror.transposed ? image.height : image.width;
  const uint32_t height = mirror.transposed ? image.width : image.height;
  const bool turnsAxes = isNormal && mirror.transposed;
  const float signX = isNormal && mirror.leftRight != mirror.transposed ? -1.f : 1.f;
  const float signY = isNormal && mirror.upsideDown != mirror.transposed ? -1.f : 1.f;
  std::vector<float> pixels(size_t{3} * width * height);
  for (uint64_t p = 0; p < pixels.size() / 3; ++p) {
    const float* from = image.pixels + mirroredPixel(p, width, height, mirror) * image.stride;
    pixels[3 * p] = signX * from[turnsAxes ? 1 : 0];
    pixels[3 * p + 1] = signY * from[turnsAxes ? 0 : 1];
    pixels[3 * p + 2] = from[2];
  }
  return pixels;
}

}  // namespace xrds
