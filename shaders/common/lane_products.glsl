// The products of lane kernels whose workgroups have a tile of the weights at texel gl_WorkGroupID.x * kTexels of the
// binding `weights`, in the order in which they are read: kRows rows of eight outputs, then of the next eight
// (lane_products.h). The kernel defines kInputs, kTile, kRows and kStoresEights and includes uniform_store.glsl before it.
//
// The tile lies in shared memory and is read at constant offsets, outside of any branch or loop that survives compilation:
// only then is a read a broadcast operand of the multiplication. With XRDS_ADDRESSED it is read by address
// (lane_weights.glsl), in a loop, which makes the code short.
#ifndef XRDS_SHADERS_COMMON_LANE_PRODUCTS_GLSL
#define XRDS_SHADERS_COMMON_LANE_PRODUCTS_GLSL
#include "shaders/common/lane_weights.glsl"
const uint kTileQuads = kTile / 4;
const uint kTexels = kRows * kTileQuads;
vec4 x[kInputs / 4];     // the inputs of the lane
uint laneTarget[kLanes];  // of a lane's token or square, in the target
#ifdef XRDS_ADDRESSED
#define STAGE_TILE(weights)
#define EVERY_PAIR [[dont_unroll]]
#else
shared vec4 tile[kTexels];
#define STAGE_TILE(weights) STAGE_WEIGHTS(tile, weights, gl_WorkGroupID.x * kTexels, kTexels)
#define EVERY_PAIR [[unroll]]
#endif

// The weights of row k for the outputs of quad n, or of n + 1: its second, of a pair. All but n is constant.
vec4 weightAt(uint n, const uint k, const bool isPair, const uint second) {
  const uint at = k * (isPair ? 2 : 1) + second;
#ifdef XRDS_ADDRESSED
  return weightsFrom(gl_WorkGroupID.x * kTexels + n * kRows).texel[at];
#else
  return tile[n * kRows + at];
#endif
}

// Adds to the sums of quad n, and of n + 1 if there is one, the products of x.
void addProducts(inout vec4 a, inout vec4 b, uint n, const bool isPair) {
  [[unroll]] for (uint k = 0; k < kInputs / 4; k++) {
    if (k > 0) endBlock(a, b);
    const vec4 v = x[k];
    a = plusProduct(a, v.x, weightAt(n, 4 * k, isPair, 0));
    if (isPair) b = plusProduct(b, v.x, weightAt(n, 4 * k, isPair, 1));
    a = plusProduct(a, v.y, weightAt(n, 4 * k + 1, isPair, 0));
    if (isPair) b = plusProduct(b, v.y, weightAt(n, 4 * k + 1, isPair, 1));
    a = plusProduct(a, v.z, weightAt(n, 4 * k + 2, isPair, 0));
    if (isPair) b = plusProduct(b, v.z, weightAt(n, 4 * k + 2, isPair, 1));
    a = plusProduct(a, v.w, weightAt(n, 4 * k + 3, isPair, 0));
    if (isPair) b = plusProduct(b, v.w, weightAt(n, 4 * k + 3, isPair, 1));
  }
}

// Stores the outputs of all lanes, the first four `at` behind laneTarget, and the second of a pair.
void storeOutputs(uint at, const bool isPair, WIDE4 first, WIDE4 second) {
  const WIDE8 both = WIDE8(first, second);
  [[unroll]] for (uint l = 0; l < kLanes; l++)
    if (isPair && kStoresEights) {
      storeLane8((at + laneTarget[l]) / 2, both, l);
    } else {
      storeLane(at + laneTarget[l], first, l);
      if (isPair) storeLane(at + 1 + laneTarget[l], second, l);
    }
}

#endif
