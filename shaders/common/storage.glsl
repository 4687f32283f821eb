// Stores of four channels at once; XRDS_F16 selects the storage type of the output. Reads are texelFetch.
#ifndef XRDS_SHADERS_COMMON_STORAGE_GLSL
#define XRDS_SHADERS_COMMON_STORAGE_GLSL

#ifdef XRDS_F16
#include "shaders/common/half.glsl"
#define STORED4 uvec2
uvec2 stored4(vec4 v) { return packHalf4(v); }
#else
#define STORED4 vec4
vec4 stored4(vec4 v) { return v; }
#endif

#endif
