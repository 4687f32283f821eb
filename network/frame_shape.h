#pragma once

#include <cstdint>

namespace xrds {

/// Size of the low-resolution colour in pixels; the output is `scale` times that.
struct FrameShape {
  uint32_t height = 0, width = 0;
};

/// The longest side of an output, in pixels.
inline constexpr uint32_t kMaxSide = 65536;

}  // namespace xrds
