#pragma once

#include <cstdint>
#include <string>

#include "image/image.h"

namespace xrds {

/// A rectangle of pixels in the coordinates of an EXR file: both corners belong to it, and the origin may lie anywhere.
struct Box {
  int32_t minX = 0;
  int32_t minY = 0;
  int32_t maxX = -1;
  int32_t maxY = -1;

  int64_t width() const { return int64_t{maxX} - minX + 1; }
  int64_t height() const { return int64_t{maxY} - minY + 1; }

  bool operator==(const Box&) const = default;
};

/// The box as text, such as "1920 x 1080 at (-8, -8)".
std::string toString(const Box& box);

/// The box that covers the same part of the picture with `scale` times as many pixels in each direction:
/// min' = min * scale, max' = (max + 1) * scale - 1. Throws Error when `scale` is not positive or the result does not
/// fit in 32-bit coordinates.
Box scaledBox(const Box& box, int scale);

/// The integer scale, at least 1, that turns display window `low` into display window `high`. Throws Error when there
/// is none.
int scaleBetween(const Box& low, const Box& high);

/// The image that covers `from`, cut and filled up with zeros so that it covers `to`: how a file that stores only a
/// crop is brought to the frame it was cropped from. Throws Error when the image does not have the size of `from`.
Image placedInBox(const Image& image, const Box& from, const Box& to);

}  // namespace xrds
