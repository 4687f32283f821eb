// What tile kernels multiply, four at a time, as it lies in shared memory. In the family `half` (XRDS_HALF) these are
// halves, and few products are added up as halves before they go to a sum in fp32: where a GPU takes two halves in the
// place of a float, that is half the instructions, and half the traffic of shared memory.
#ifndef XRDS_SHADERS_COMMON_FACTORS_GLSL
#define XRDS_SHADERS_COMMON_FACTORS_GLSL

#ifdef XRDS_HALF
#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require
#define FACTOR4 f16vec4

// Of four inputs with their weights of four outputs.
f16vec4 sumOfFour(f16vec4 weights[4], f16vec4 inputs) {
  f16vec4 sum = weights[0] * inputs[0];
  [[unroll]] for (uint i = 1; i < 4; i++) sum += weights[i] * inputs[i];
  return sum;
}
#else
#define FACTOR4 vec4
#endif

#endif
