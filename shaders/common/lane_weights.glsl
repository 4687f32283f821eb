// Weights that a lane kernel reads by address, with XRDS_ADDRESSED: the last 8 bytes of the push constants. For drivers that
// know uniforms, but test the range of each number in shared memory and call a function for each texel (Mesa from 25.1
// on): here a number that all lanes read is an operand of the multiplication, also in loops. Included after
// uniform_store.glsl.
#ifndef XRDS_SHADERS_COMMON_LANE_WEIGHTS_GLSL
#define XRDS_SHADERS_COMMON_LANE_WEIGHTS_GLSL
#ifdef XRDS_ADDRESSED
#extension GL_EXT_buffer_reference : require
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Weights { vec4 texel[]; };

Weights weightsFrom(uint texel) {
  const uint last = (1 << kDigitBits) - 1;
  return Weights(word64(uvec2(digit[last - 1], digit[last])) + uint64_t(texel) * 16);
}

#endif

// Without it the compiler makes hundreds of products before it adds the first, and keeps them in memory: the branch, which
// is never taken, needs the sums so far.
void endBlock(vec4 a, vec4 b) {
#ifdef XRDS_ADDRESSED
  if (digit[0] != 0) target8[0] = wide8(a, b);
#endif
}

#endif
