// Half floats rounded to nearest even whatever the device's packHalf2x16 does (lavapipe's truncates, which is a bias).
// What is too large for a half becomes the largest one, not infinity, of which the next sums would make NaN.
#ifndef XRDS_SHADERS_COMMON_HALF_GLSL
#define XRDS_SHADERS_COMMON_HALF_GLSL

const float kLargestHalf = 65504.0;

// The value with the ten fraction bits of a half: packing it is then exact. NaN stays NaN. All of it by integers: a driver may
// make min() of a comparison and a choice, and that of NVIDIA, asked for the smaller of NaN and a number, takes the number.
vec4 roundedToHalf(vec4 v) {
  const uint kLargest = 0x477FE000u, kInfinity = 0x7F800000u;  // kLargestHalf
  const uvec4 bits = floatBitsToUint(v), magnitude = bits & 0x7FFFFFFFu;
  uvec4 rounded = (bits + 0xFFFu + (bits >> 13 & 1u)) & ~0x1FFFu;
  rounded = mix(rounded, bits & 0x80000000u | kLargest, greaterThan(magnitude, uvec4(kLargest)));
  return uintBitsToFloat(mix(rounded, bits, greaterThan(magnitude, uvec4(kInfinity))));
}

uvec2 packHalf4(vec4 v) {
  const vec4 r = roundedToHalf(v);
  return uvec2(packHalf2x16(r.xy), packHalf2x16(r.zw));
}

#endif
