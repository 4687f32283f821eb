// Included by GLSL and C++: what the fragment shader of the canvas is told of a frame.
#ifndef XRDS_VIEWER_PICTURE_PARAMETERS_H
#define XRDS_VIEWER_PICTURE_PARAMETERS_H

#ifdef __cplusplus
#include <cstdint>
namespace xrds::shader {
using uint = uint32_t;
#endif

const uint kKindRadiance = 0;  // linear: exposure, tone curve
const uint kKindAlbedo = 1;    // linear: no exposure, sRGB
const uint kKindNormal = 2;    // [-1, 1]
const uint kKindError = 3;     // against the reference, as a heat map

const uint kCurveSrgb = 0;    // clamped to [0, 1]
const uint kCurveFilmic = 1;  // highlights roll off

/// How a picture lies in its texel buffer: rows from the top, `stride` floats a pixel, three of which from `channel`
/// on are shown.
struct Picture {
  uint kind, width, height, stride, channel;
};

/// Lengths on the display are in its pixels, from the top left.
struct PictureParameters {
  Picture left, right;     // of the divider
  float originX, originY;  // where the corner of the output lies
  float zoom;              // display pixels in a pixel of the output
  float divider;
  uint width, height;  // of the output; the pictures cover the same area
  float exposure;
  uint curve;
  float leastErrorLog10, mostErrorLog10;  // ends of the heat map
};

#ifdef __cplusplus
}  // namespace xrds::shader
#endif
#endif
