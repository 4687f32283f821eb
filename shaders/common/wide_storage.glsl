// Stores of four and eight channels as 64-bit words: a CPU device stores lane by lane and word by word, so wide is fast.
// XRDS_F16 selects the storage type of the output.
#ifndef XRDS_SHADERS_COMMON_WIDE_STORAGE_GLSL
#define XRDS_SHADERS_COMMON_WIDE_STORAGE_GLSL
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

// Two words as one of 64 bits. Not packUint2x32: with vectors of 512 bits, Mesa 26.2's compiler overruns its stack on it.
uint64_t word64(uvec2 v) { return uint64_t(v.x) | uint64_t(v.y) << 32; }

#ifdef XRDS_F16
#include "shaders/common/half.glsl"
#define WIDE4 uint64_t
#define WIDE8 u64vec2
WIDE4 wide4(vec4 v) { return word64(packHalf4(v)); }
#else
#define WIDE4 u64vec2
#define WIDE8 u64vec4
WIDE4 wide4(vec4 v) { return u64vec2(word64(floatBitsToUint(v.xy)), word64(floatBitsToUint(v.zw))); }
#endif
WIDE8 wide8(vec4 a, vec4 b) { return WIDE8(wide4(a), wide4(b)); }

#endif
