// The products of lane kernels whose workgroups have a tile of the weights, [K][kTile], at texel gl_WorkGroupID.x * kTexels
// of the binding `weights`. The kernel defines K = kInputs, kTile and kTexels and includes uniform_store.glsl before it.
//
// The tile lies in shared memory and is read at constant offsets, outside of any branch or loop that survives compilation:
// only then is a read a broadcast operand of the multiplication. With XRDS_ADDRESSED it is read by address
// (lane_weights.glsl), in a loop, which makes the code short.
#ifndef XRDS_SHADERS_COMMON_LANE_PRODUCTS_GLSL
#define XRDS_SHADERS_COMMON_LANE_PRODUCTS_GLSL
#include "shaders/common/lane_weights.glsl"
const uint kTileQuads = kTile / 4;
vec4 x[kInputs / 4];  // the inputs of the lane
#ifdef XRDS_ADDRESSED
#define STAGE_TILE(weights)
#define EVERY_PAIR [[dont_unroll]]
#else
shared vec4 tile[kTexels];
#define STAGE_TILE(weights) STAGE_WEIGHTS(tile, weights, gl_WorkGroupID.x * kTexels, kTexels)
#define EVERY_PAIR [[unroll]]
#endif

// Texel n + at of the tile. `at` is constant.
vec4 weightAt(uint n, const uint at) {
#ifdef XRDS_ADDRESSED
  return weightsFrom(gl_WorkGroupID.x * kTexels + n).texel[at];
#else
  return tile[n + at];
#endif
}

// Adds to the sums of quad n, and of n + 1 if there is one, the products of x.
void addProducts(inout vec4 a, inout vec4 b, uint n, bool isPair) {
  [[unroll]] for (uint k = 0; k < kInputs / 4; k++) {
    const vec4 v = x[k];
    const uint at = 4 * k * kTileQuads;
    if (k > 0) endBlock(a, b);
    a = plusProduct(a, v.x, weightAt(n, at));
    if (isPair) b = plusProduct(b, v.x, weightAt(n, at + 1));
    a = plusProduct(a, v.y, weightAt(n, at + kTileQuads));
    if (isPair) b = plusProduct(b, v.y, weightAt(n, at + kTileQuads + 1));
    a = plusProduct(a, v.z, weightAt(n, at + 2 * kTileQuads));
    if (isPair) b = plusProduct(b, v.z, weightAt(n, at + 2 * kTileQuads + 1));
    a = plusProduct(a, v.w, weightAt(n, at + 3 * kTileQuads));
    if (isPair) b = plusProduct(b, v.w, weightAt(n, at + 3 * kTileQuads + 1));
  }
}

#endif
