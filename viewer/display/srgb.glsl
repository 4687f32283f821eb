// The sRGB curve.
#ifndef XRDS_VIEWER_SRGB_GLSL
#define XRDS_VIEWER_SRGB_GLSL

vec3 srgb(vec3 linear) {
  const vec3 c = clamp(linear, 0.0, 1.0);
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}

#endif
