#pragma once

#include <cstdint>

namespace xrds {

/// A view of pixels that the caller owns: rows from the top, `stride` floats from one pixel to the next, the first
/// three of which are R, G, B (linear radiance or albedo) or X, Y, Z (a normal).
struct PixelView {
  const float* pixels = nullptr;
  uint32_t width = 0, height = 0;
  uint32_t stride = 3;
};

}  // namespace xrds
