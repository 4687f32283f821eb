#pragma once

#include <optional>
#include <vector>

#include "xrds/pixel_view.h"

namespace xrds {

/// One frame on the host, pixels of the caller.
struct FrameInput {
  PixelView colour;                        // [h, w], linear radiance
  std::vector<PixelView> auxiliary{};      // [s h, s w] each, in the model's order
  std::optional<float> exposure{};         // empty: computed over the whole frame
  std::optional<float> inverseExposure{};  // as a device computed it; empty: 1 / exposure
};

/// Copies `width` pixels of row y, from column x on, three floats each, to every `stride`th float of `to`. Columns are
/// cyclic: those left of the image are on its right.
void copyRow(const PixelView& image, int64_t x, uint32_t y, uint32_t width, float* to, uint32_t stride);

/// The image with three tightly packed floats a pixel.
std::vector<float> packed(const PixelView& image);

}  // namespace xrds
