// Numbers that are not finite, by their bits: isnan() and isinf() may be false where a compiler takes all numbers for
// finite, as Metal's does by default and Vulkan allows.
#ifndef XRDS_SHADERS_COMMON_FINITE_GLSL
#define XRDS_SHADERS_COMMON_FINITE_GLSL

const uint kInfinityBits = 0x7F800000u;

uvec3 magnitudeBits(vec3 x) { return floatBitsToUint(x) & 0x7FFFFFFFu; }

bool isFinite(vec3 x) { return all(lessThan(magnitudeBits(x), uvec3(kInfinityBits))); }

vec3 withoutNan(vec3 x) { return mix(x, vec3(0), greaterThan(magnitudeBits(x), uvec3(kInfinityBits))); }

#endif
