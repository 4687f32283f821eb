#pragma once

#include <cstdint>

namespace xrds {

/// A view of pixels that the caller owns: rows from the top, `stride` floats from one pixel to the next, the first
/// three of which are R, G, B (linear radiance or albedo), X, Y, Z (a normal) or a relative depth.
struct PixelView {
  const float* pixels = nullptr;
  uint32_t width = 0, height = 0;
  uint32_t stride = 3;
};

}  // namespace xrds
