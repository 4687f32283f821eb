// What a denoiser's network sees of the values of an image, between 0 and 1.
#ifndef XRDS_SHADERS_COMMON_FRAME_CURVE_H
#define XRDS_SHADERS_COMMON_FRAME_CURVE_H
#include "shaders/common/image.h"

XRDS_SHARED_BEGIN
const uint kFrameHdr = 0;     // linear radiance: the perceptually uniform curve
const uint kFrameLdr = 1;     // linear, from 0 to 1: the sRGB curve
const uint kFrameNormal = 2;  // from -1 to 1: brought to 0 to 1
// The perceptually uniform curve has three parts: a y; b y^c + d from y0 on; e log(y + f) + g from y1 on.
const float kPuA = 1.41283765e+03f, kPuB = 1.64593172e+00f, kPuC = 4.31384981e-01f, kPuD = -2.94139609e-03f,
            kPuE = 1.92653254e-01f, kPuF = 6.26026094e-03f, kPuG = 9.98620152e-01f;
const float kPuY0 = 1.57945760e-06f, kPuY1 = 3.22087631e-02f;
const float kPuX0 = 2.23151711e-03f, kPuX1 = 3.70974749e-01f;  // of y0 and y1
const float kPuMost = 3.1351190f;                              // of 65504, which the network sees as 1
const float kFrameMax = 3.4028234e38f;
XRDS_SHARED_END

#ifdef __cplusplus
#include <cmath>
namespace xrds {

/// Which curve: of linear radiance without bound, of linear values up to 1 such as albedo, of unit vectors.
enum class FrameCurve : uint32_t { hdr, ldr, normal };

/// Value as seen by the network, and back, in double precision, for reference().
double curved(FrameCurve curve, double value);
double uncurved(FrameCurve curve, double seen);

}  // namespace xrds
#endif
#endif
