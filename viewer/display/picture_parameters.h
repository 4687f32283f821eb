// Included by GLSL and C++: what the fragment shader of the canvas is told of a picture.
#ifndef XRDS_VIEWER_PICTURE_PARAMETERS_H
#define XRDS_VIEWER_PICTURE_PARAMETERS_H

#ifdef __cplusplus
#include <cstdint>
namespace xrds::shader {
using uint = uint32_t;
#endif

const uint kKindRadiance = 0;  // linear: exposure, tone curve
const uint kKindAlbedo = 1;    // linear: no exposure, sRGB
const uint kKindNormal = 2;    // [-1, 1], of the second plane
const uint kKindError = 3;     // against the reference, as a heat map
const uint kKindSkip = 4;      // radiance, under the map of what was not computed
const uint kKindFlicker = 5;   // a deviation over time, as a heat map
const uint kKindCount = 6;

const uint kCurveSrgb = 0;    // clamped to [0, 1]
const uint kCurveFilmic = 1;  // highlights roll off

// Ends of the heat map of errors, whose steps are even in the logarithm.
const float kLeastErrorLog10 = -4.0f;
const float kMostErrorLog10 = 0.0f;
// And of that of deviations over time, of sRGB values in [0, 1].
const float kLeastFlickerLog10 = -3.0f;
const float kMostFlickerLog10 = 0.0f;

/// Of one channel; the mean over the channels is what RelMSE has for a pixel.
#ifdef __cplusplus
inline
#endif
    float
    relativeSquaredError(float found, float expected) {
  const float difference = found - expected;
  return difference * difference / (expected * expected + 0.01f);
}

/// How a picture lies in its texel buffer: rows from the top, each with those of its planes, one after the other.
struct Picture {
  uint width, height, planes;
};

/// Lengths on the display are in its pixels, from the top left.
struct PictureParameters {
  Picture picture;
  uint width, height;      // of the output; every picture covers the same area
  float originX, originY;  // where its corner lies
  float zoom;              // display pixels in a pixel of it
  float exposure;
  uint curve;
  uint windowSide;  // of the skip map, in pixels of the output
};

#ifdef __cplusplus
}  // namespace xrds::shader
#endif
#endif
