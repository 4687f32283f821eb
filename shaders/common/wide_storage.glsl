// Stores of four and eight channels as 64-bit words: a CPU device stores lane by lane and word by word, so wide is fast.
// XRDS_F16 selects the storage type of the output.
#ifndef XRDS_SHADERS_COMMON_WIDE_STORAGE_GLSL
#define XRDS_SHADERS_COMMON_WIDE_STORAGE_GLSL
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

#ifdef XRDS_F16
#include "shaders/common/half.glsl"
#define WIDE4 uint64_t
#define WIDE8 u64vec2
WIDE4 wide4(vec4 v) { return packUint2x32(packHalf4(v)); }
#else
#define WIDE4 u64vec2
#define WIDE8 u64vec4
WIDE4 wide4(vec4 v) { return u64vec2(packUint2x32(floatBitsToUint(v.xy)), packUint2x32(floatBitsToUint(v.zw))); }
#endif
WIDE8 wide8(vec4 a, vec4 b) { return WIDE8(wide4(a), wide4(b)); }

#endif
