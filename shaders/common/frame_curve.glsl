// The curves of frame_curve.h on three channels; `curve` is a specialization constant.
#ifndef XRDS_SHADERS_COMMON_FRAME_CURVE_GLSL
#define XRDS_SHADERS_COMMON_FRAME_CURVE_GLSL
#include "shaders/common/finite.glsl"
#include "shaders/common/frame_curve.h"

vec3 curved(uint curve, vec3 y) {
  if (curve == kFrameNormal) return clamp(withoutNan(y), -1.0, 1.0) * 0.5 + 0.5;
  if (curve == kFrameLdr) {
    y = clamp(withoutNan(y), 0.0, 1.0);
    return mix(1.055 * pow(y, vec3(1.0 / 2.4)) - 0.055, 12.92 * y, lessThanEqual(y, vec3(0.0031308)));
  }
  y = clamp(withoutNan(y), 0.0, kFrameMax);
  const vec3 middle = kPuB * pow(y, vec3(kPuC)) + kPuD, high = kPuE * log(y + kPuF) + kPuG;
  const vec3 x = mix(mix(high, middle, lessThanEqual(y, vec3(kPuY1))), kPuA * y, lessThanEqual(y, vec3(kPuY0)));
  return x / kPuMost;
}

vec3 uncurved(uint curve, vec3 x) {
  x = clamp(x, 0.0, kFrameMax);
  if (curve == kFrameNormal) return min(x * 2.0 - 1.0, 1.0);
  if (curve == kFrameLdr)
    return min(mix(pow((x + 0.055) / 1.055, vec3(2.4)), x / 12.92, lessThanEqual(x, vec3(0.04045))), 1.0);
  x *= kPuMost;
  const vec3 middle = pow(max(x - kPuD, 0.0) / kPuB, vec3(1.0 / kPuC)), high = exp((x - kPuG) / kPuE) - kPuF;
  return mix(mix(high, middle, lessThanEqual(x, vec3(kPuX1))), x / kPuA, lessThanEqual(x, vec3(kPuX0)));
}

#endif
