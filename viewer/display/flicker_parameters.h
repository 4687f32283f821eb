// Included by GLSL and C++: what flicker.comp is told.
#ifndef XRDS_VIEWER_FLICKER_PARAMETERS_H
#define XRDS_VIEWER_FLICKER_PARAMETERS_H

#ifdef __cplusplus
#include <cstdint>
namespace xrds::shader {
using uint = uint32_t;
#endif

const uint kFlickerFrames = 8;  // over which the deviation is
const uint kFlickerGroup = 8;   // side of a work group

struct FlickerParameters {
  uint width, height;
  float share;  // of the latest picture in the mean
};

#ifdef __cplusplus
}  // namespace xrds::shader
#endif
#endif
