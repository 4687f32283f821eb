#pragma once

#include <optional>
#include <span>
#include <vector>

#include "xrds/pixel_view.h"

namespace xrds {

/// The exposure of a frame and its inverse: of a given one, or both as they were computed.
struct FrameExposure {
  float value = 1, inverse = 1;
  FrameExposure() = default;
  FrameExposure(float given) : value(given), inverse(1 / given) {}  // a number is an exposure
  FrameExposure(float value, float inverse) : value(value), inverse(inverse) {}
};

/// An image beside the colour that the kernels of the base image are applied to, and where that goes.
struct LayerImage {
  PixelView image;        // [h, w]
  std::span<float> mean;  // [s h, s w, 3]
};

/// One frame on the host, pixels of the caller.
struct FrameInput {
  PixelView colour;                         // [h, w], linear radiance
  std::vector<PixelView> auxiliary{};       // [s h, s w] each, in the model's order
  std::optional<FrameExposure> exposure{};  // empty: computed over the whole frame
  std::vector<LayerImage> layers{};         // as many as the session was made for
};

/// Copies `width` pixels of row y, from column x on, three floats each, to every `stride`th float of `to`. Columns are
/// cyclic: those left of the image are on its right.
void copyRow(const PixelView& image, int64_t x, uint32_t y, uint32_t width, float* to, uint32_t stride);

/// Copies three of the four floats of each pixel of a row to the output from pixel `first` on, and adds to `lost` the
/// pixels whose fourth is not 0. Safe to be called at once for other rows of the same output.
void storeRow(std::span<const float> row, uint64_t first, std::span<float> output, std::vector<uint64_t>& lost);

/// The image with three tightly packed floats a pixel.
std::vector<float> packed(const PixelView& image);

}  // namespace xrds
