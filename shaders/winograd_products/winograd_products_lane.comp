// The products of winograd_products.comp, for CPU devices, as linear_lane.comp makes its own.
// A square a lane, kTile outputs of a plane a workgroup: gl_WorkGroupID.x is the tile, of plane 0 first. Lanes behind
// the last square repeat it. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/winograd_products/winograd_products.h"
layout(local_size_x_id = 0, local_size_y_id = 1) in;  // x = subgroup size
#define PARAMS WinogradProductsParams
#define TARGET_BINDING 2
#include "shaders/common/uniform_store.glsl"
layout(constant_id = 2) const uint kInputs = 4;  // of a plane
layout(constant_id = 3) const uint kTile = 4;
layout(constant_id = 4) const bool kStoresEights = false;  // the target begins and steps in eights
layout(constant_id = 5) const uint kFirst = 0;             // inputs whose planes lie before the others'
layout(constant_id = 6) const bool kInTurns = false;       // as in linear_lane.comp
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
const uint kRows = kInputs;
#include "shaders/common/lane_products.glsl"

void findLanes(uint firstSquare, uint firstTarget) {
  [[unroll]] for (uint l = 0; l < kLanes; l++)
    laneTarget[l] = min(firstSquare + l, p.squareEnd - 1) * p.target.stride + firstTarget;
}

// Outputs of quad n of the tile, and of n + 1 if there is one.
void makeOutputs(uint n, const bool isPair, uint firstSquare, uint firstTarget) {
  if (kInTurns && n > 0) {
    waitForTurn();
    findLanes(firstSquare, firstTarget);
  }
  vec4 a = vec4(0), b = vec4(0);
  addProducts(a, b, n, isPair);
  storeOutputs(n, isPair, wide4(a), wide4(b));
}

void main() {
  STAGE_TILE(weights);

  const uint row = gl_WorkGroupID.y * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
  const uint square = min(p.squareBegin + row * kLanes + gl_LocalInvocationID.x, p.squareEnd - 1);
  const uint firstSquare = p.squareBegin + uniformOf(row, 6) * kLanes;
  const uint firstTarget = p.target.offset + uniformOf(gl_WorkGroupID.x, 4) * kTileQuads - p.storeOrigin;
  findLanes(firstSquare, firstTarget);
  const uint plane = gl_WorkGroupID.x * kTileQuads / p.outputQuads;
  const uint start = square * p.source.stride + p.source.offset;
  const uint firsts = start + plane * (kFirst / 4);
  const uint others = start + kWinogradPlanes * (kFirst / 4) + plane * (kInputs - kFirst) / 4;
  // One texel of each cache line first, so that the processor waits for all of them at the same time.
  [[unroll]] for (uint part = 0; part < 4; part++)
    [[unroll]] for (uint line = 0; line < (kInputs + 15) / 16; line++) {
      const uint k = 4 * line + part;
      if (k < kInputs / 4) x[k] = texelFetch(source, int(k < kFirst / 4 ? firsts + k : others + k - kFirst / 4));
    }

  EVERY_PAIR for (uint m = 0; m < kTileQuads / 2; m++) makeOutputs(2 * m, true, firstSquare, firstTarget);
  if (kTileQuads % 2 == 1) makeOutputs(kTileQuads - 1, false, firstSquare, firstTarget);
}
