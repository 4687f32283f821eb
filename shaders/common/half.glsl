// Half floats rounded to nearest even whatever the device's packHalf2x16 does (lavapipe's truncates, which is a bias).
// What is too large for a half becomes the largest one, not infinity, of which the next sums would make NaN.
#ifndef XRDS_SHADERS_COMMON_HALF_GLSL
#define XRDS_SHADERS_COMMON_HALF_GLSL

const float kLargestHalf = 65504.0;

// The value with the ten fraction bits of a half: packing it is then exact. NaN stays NaN.
vec4 roundedToHalf(vec4 v) {
  v = mix(v, vec4(kLargestHalf), greaterThan(v, vec4(kLargestHalf)));
  v = mix(v, vec4(-kLargestHalf), lessThan(v, vec4(-kLargestHalf)));
  const uvec4 bits = floatBitsToUint(v);
  const vec4 rounded = uintBitsToFloat((bits + 0xFFFu + (bits >> 13 & 1u)) & ~0x1FFFu);
  return mix(rounded, v, isnan(v));
}

uvec2 packHalf4(vec4 v) {
  const vec4 r = roundedToHalf(v);
  return uvec2(packHalf2x16(r.xy), packHalf2x16(r.zw));
}

#endif
