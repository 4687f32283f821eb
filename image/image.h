#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace xrds {

/// A rectangle of floating-point pixels: rows from top to bottom, pixels from left to right, the channels of a pixel
/// side by side. Radiance and albedo are linear, normals lie in [-1, 1].
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> pixels;

  Image() = default;

  /// An image of w x h pixels with c channels whose every value is `fill`. None of the sizes may be negative.
  Image(int w, int h, int c, float fill = 0.0F)
      : width(w),
        height(h),
        channels(c),
        pixels(static_cast<size_t>(w) * static_cast<size_t>(h) * static_cast<size_t>(c), fill) {}

  /// An image of w x h pixels with c channels of these values, of which there must be as many.
  Image(int w, int h, int c, std::vector<float> values) : width(w), height(h), channels(c), pixels(std::move(values)) {}

  /// The number of pixels, whatever their channels.
  size_t pixelCount() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }

  /// Where channel `c` of the pixel in column `x` and row `y` lies in `pixels`; all three must be inside the image.
  size_t index(int x, int y, int c = 0) const {
    return (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) *
               static_cast<size_t>(channels) +
           static_cast<size_t>(c);
  }

  /// The value of channel `c` of the pixel in column `x` and row `y`; all three must be inside the image.
  float at(int x, int y, int c) const { return pixels[index(x, y, c)]; }
  float& at(int x, int y, int c) { return pixels[index(x, y, c)]; }

  bool operator==(const Image&) const = default;
};

}  // namespace xrds
