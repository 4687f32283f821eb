#pragma once

#include "image/image.h"
#include "xrds/merged_colour.h"

namespace xrds {

/// Two cheap renders of one frame: the low-resolution colour [h, w, >= 3], and of a full-resolution render [s h, s w]
/// colour, albedo and normal, >= 3 channels each. Radiance is linear; `samples` a pixel of the two.
struct CheapRenders {
  const Image &low, &full, &albedo, &normal;
  RenderSamples samples;
};

/// What two cheap renders tell of a scene: logarithms to the base 2 of mean squares, of the picture that the sRGB
/// curve makes of radiance in [0, 1]. docs/advice.md has the formulas.
struct SceneFeatures {
  double noise = 0;       // the variance of one sample a pixel
  double detail = 0;      // of the differences between neighbours at low resolution, without their noise
  double guideNoise = 0;  // what a median of 3 x 3 takes out of albedo and normal, for one sample a pixel
};

/// Throws Error if the sizes are no whole multiple of each other, or a sample count is not positive.
SceneFeatures sceneFeatures(const CheapRenders& renders);

}  // namespace xrds
