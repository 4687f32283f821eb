#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "xrds/image_call.h"
#include "xrds/pixel_view.h"
#include "xrds/xrds_report.h"

namespace xrds {

/// Samples a pixel of the two renders of a frame: of the low-resolution colour, and of the full-resolution render whose
/// albedo and normals are the auxiliary images.
struct RenderSamples {
  double low = 0, full = 0;
};

/// The share s^2 K / (k + s^2 K) that the colour of the full-resolution render has in the merged one, for k and K
/// samples and the scale s. Throws Error unless both counts are positive and finite.
inline double fullShare(RenderSamples samples, uint32_t scale) {
  if (!(samples.low > 0) || !(samples.full > 0) || !std::isfinite(samples.low) || !std::isfinite(samples.full))
    throw InvalidArgument("Samples of " + std::to_string(samples.low) + " and " + std::to_string(samples.full) +
                          " a pixel were given, expected two positive numbers.");
  const double full = static_cast<double>(scale) * scale * samples.full;
  return full / (samples.low + full);
}

/// The share where no counts are known, from the noise of the two images, which are of one frame: [h, w, >= 3] and
/// [s h, s w, >= 3] linear radiance, s at least 2. The noise of a mean of s x s pixels is read from the difference of
/// its two halves, a chequerboard; that of the low-resolution colour is what else differs. Both are taken relative to
/// the radiance of 3 x 3 low-resolution pixels, and of all of these the middle half counts, so single bright pixels do
/// not. The ratio of samples that it stands for is within a factor of two of the true one for 91 % of 506 pairs of
/// renders, of four for 99 %. One half where neither has noise.
inline double estimatedFullShare(const PixelView& low, const PixelView& full) {
  double share = 0;
  const XrdsImage images[] = {call::image(low, "low-resolution"), call::image(full, "full-resolution")};
  call::check(xrdsEstimateFullShare(&images[0], &images[1], &share));
  return share;
}

/// How much the two differ beside noise: |a - b| / (a + b) of the means of sixteen parts of the frame, their median.
/// Renders of the same light have less than kMostColourDifference; a full-resolution render without indirect light,
/// say, has more, and must not be merged.
inline double colourDifference(const PixelView& low, const PixelView& full) {
  double difference = 0;
  const XrdsImage images[] = {call::image(low, "low-resolution"), call::image(full, "full-resolution")};
  call::check(xrdsCompareColour(&images[0], &images[1], &difference));
  return difference;
}
inline constexpr double kMostColourDifference = 0.1;

/// The merged colour [h, w, 3]: (1 - share) L + share B, with the low-resolution colour L [h, w, >= 3] and the means B
/// of s x s pixels of the full-resolution render's colour [s h, s w, >= 3]. Of both, and in all functions of this file,
/// negative values are 0 and pixels that are not finite are filled from their neighbours. Throws Error if the sizes are
/// no whole multiple of each other.
inline std::vector<float> mergedColour(const PixelView& low, const PixelView& full, double share) {
  std::vector<float> merged(size_t{3} * low.width * low.height);
  const XrdsImage images[] = {call::image(low, "low-resolution"), call::image(full, "full-resolution"),
                              call::image(merged, low.width, low.height)};
  call::check(xrdsMergeByShare(&images[0], &images[1], share, &images[2]));
  return merged;
}

/// The full-resolution render's colour H [s h, s w, >= 3] at the level of the merged one M [h, w, >= 3], three floats a
/// pixel: H (M + t) / (B + t), the ratio at most 8, with the means B of s x s pixels of H and a hundredth of the mean
/// of M as t. What a denoiser takes best: its means have the noise of both renders, and only what is finer that of H
/// alone. Throws Error if the sizes are no whole multiple of each other.
inline std::vector<float> levelledColour(const PixelView& full, const PixelView& merged) {
  std::vector<float> levelled(size_t{3} * full.width * full.height);
  const XrdsImage images[] = {call::image(full, "full-resolution"), call::image(merged, "merged"),
                              call::image(levelled, full.width, full.height)};
  call::check(xrdsLevelColour(&images[0], &images[1], &images[2]));
  return levelled;
}

}  // namespace xrds
