#pragma once

#include <span>
#include <string>

#include "frames/window_mask.h"
#include "network/config.h"
#include "xrds/pixel_view.h"

namespace xrds {

/// Why no window of this model's frames may be left out, as the end of a sentence that names the model; empty if they
/// may: the model must add its output to a base image, in the logarithmic domain.
std::string whyNeverQuiet(const NetworkConfig& config);

/// Finds the windows of a frame that need no network, and interpolates them. With r = I / (b + 0.02), the colour over
/// the box mean of the albedo (r = I if the base image does not demodulate), a window is quiet if in it and two pixels
/// around it
/// - log(1 + e r) varies by at most `bound` in each channel: background, clear sky, converged and evenly lit surfaces;
/// - no pixel of the albedo is further than `bound` (b + 0.02) from its box mean b: no edge, texture or noise;
/// - all other auxiliary images are constant but for 1/128: no edge and no bump. Where they are zero, as renderers
///   write the normals of the background, the first limit is four times as wide, the second, on clouds, 16 times.
/// Whatever kernels the network predicts, the base image then varies by about `bound` at most. What is left is the
/// network's residual; bench/skip.md has its size.
class QuietWindows {
 public:
  /// colour [h, w], auxiliary [s h, s w] each in the model's order; they are read here and in fill(). Throws Error if
  /// whyNeverQuiet().
  QuietWindows(const NetworkConfig& config, const PixelView& colour, std::span<const PixelView> auxiliary,
               float exposure, float bound);

  /// The windows that are not quiet.
  const WindowMask& needed() const { return needed_; }

  /// Interpolates r bilinearly in the marked windows and writes r (a + 0.02) with the albedo a to output [s h, s w, 3].
  void fill(const WindowMask& marked, std::span<float> output) const;

 private:
  struct Guide {  // the least and the greatest value of an image's channels in a box of s x s pixels
    float least[3], greatest[3];
  };
  void readBoxes(std::span<const PixelView> guides);
  bool quiet(uint32_t row, uint32_t column, float exposure, float bound) const;
  void fillWindow(uint32_t row, uint32_t column, std::span<float> output) const;

  uint32_t scale_, windowSize_;
  FrameShape frame_;
  PixelView colour_, albedo_{};    // an albedo without pixels: the base image does not demodulate
  std::vector<float> ratios_;      // r, [h, w, 3]; NaN where the auxiliary images are not finite
  std::vector<float> unevenness_;  // of the albedo, [h, w]
  std::vector<Guide> guides_;      // [h, w, guide images]
  size_t guideCount_ = 0;
  WindowMask needed_;
};

}  // namespace xrds
