// y = activation(x W^T + b) + residual as in linear.comp, norm included, for CPU devices.
// A token a lane, kTile outputs a workgroup (gl_WorkGroupID.x). Eight outputs at a time, four inputs written out, as
// drivers are slow to unroll. kInTurns: all subgroups of the workgroup make the same eight before the next, so that their
// code is read from the instruction cache. Lanes behind the last token repeat it. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/activation.glsl"
#include "shaders/linear/linear.h"
layout(local_size_x_id = 0, local_size_y_id = 5) in;  // x = subgroup size
#define PARAMS LinearParams
#define TARGET_BINDING 3
#include "shaders/common/uniform_store.glsl"
layout(constant_id = 1) const uint kInputs = 4;
layout(constant_id = 2) const uint kTile = 4;
layout(constant_id = 3) const uint kActivation = kActivationNone;
layout(constant_id = 4) const bool kHasResidual = false;
layout(constant_id = 6) const bool kStoresEights = false;  // the slice of the target begins and steps in eights
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2) uniform samplerBuffer residual;
layout(constant_id = 7) const bool kNormalizes = false;
layout(constant_id = 8) const uint kSourceQuads = 1;  // those behind them are of `appended`
const uint kAppendedQuads = kInputs / 4 - kSourceQuads;
layout(constant_id = 9) const bool kInTurns = false;
layout(binding = 4) uniform samplerBuffer appended;
const uint kRows = kInputs + 1;  // the last one is the bias
#include "shaders/common/lane_products.glsl"

vec4 finished(vec4 sum, uint token, uint quad) {
  vec4 y = activate(kActivation, sum);
  if (kHasResidual) y += texelFetch(residual, int(token * p.residual.stride + p.residual.offset + quad));
  return y;
}

void findLanes(uint firstToken) {
  [[unroll]] for (uint l = 0; l < kLanes; l++)
    laneTarget[l] = (min(firstToken + l, p.tokenEnd - 1) - firstToken) * p.target.stride;
}

// Outputs of quad n of the tile, and of n + 1 if there is one.
void makeOutputs(uint n, const bool isPair, uint token, uint firstToken, uint firstTarget) {
  if (kInTurns && n > 0) {
    waitForTurn();
    findLanes(firstToken);  // a compiler would compute those from before the barrier again for each store
  }
  vec4 a = weightAt(n, kInputs, isPair, 0), b = isPair ? weightAt(n, kInputs, isPair, 1) : vec4(0);
  addProducts(a, b, n, isPair);
#ifdef XRDS_F16
  // A first store, which the rounded sums overwrite, keeps the compiler from rounding each sum as soon as it has it: it
  // would compute one after the other, waiting for each addition, in three times the time.
  if (!kHasResidual)
    target[firstTarget + n + laneTarget[0]] = handedOut(word64(floatBitsToUint(vec2(a.x, b.x))), 0);
#endif
  const uint quad = gl_WorkGroupID.x * kTileQuads + n;
  const WIDE4 first = wide4(finished(a, token, quad)), second = isPair ? wide4(finished(b, token, quad + 1)) : first;
  storeOutputs(firstTarget + n, isPair, first, second);
}

void main() {
  STAGE_TILE(weights);

  const uint row = gl_WorkGroupID.y * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
  const uint token = min(p.tokenBegin + row * kLanes + gl_LocalInvocationID.x, p.tokenEnd - 1);
  const uint firstToken = p.tokenBegin + uniformOf(row, 6) * kLanes;
  findLanes(firstToken);
  const uint firstTarget = firstToken * p.target.stride + p.target.offset +
                           uniformOf(gl_WorkGroupID.x, 3) * kTileQuads - p.storeOrigin;
  // One texel of each cache line first, so that the processor waits for all of them at the same time.
  [[unroll]] for (uint part = 0; part < 4; part++) {
    [[unroll]] for (uint line = 0; line < (kSourceQuads + 3) / 4; line++) {
      const uint k = 4 * line + part;
      if (k < kSourceQuads) x[k] = texelFetch(source, int(token * p.source.stride + p.source.offset + k));
    }
    [[unroll]] for (uint line = 0; line < (kAppendedQuads + 3) / 4; line++) {
      const uint k = 4 * line + part;
      if (k < kAppendedQuads)
        x[kSourceQuads + k] = texelFetch(appended, int(token * p.appended.stride + p.appended.offset + k));
    }
  }
  if (kNormalizes) {
    vec4 sum = vec4(0), squares = vec4(0);
    [[unroll]] for (uint k = 0; k < kInputs / 4; k++) sum += x[k];
    const float mean = dot(sum, vec4(1)) / float(kInputs);
    [[unroll]] for (uint k = 0; k < kInputs / 4; k++) {
      x[k] -= mean;
      squares += x[k] * x[k];
    }
    const float scale = inversesqrt(dot(squares, vec4(1)) / float(kInputs) + p.epsilon);
    [[unroll]] for (uint k = 0; k < kInputs / 4; k++) x[k] *= scale;
    if (kInTurns)
      [[unroll]] for (uint k = 0; k < kInputs / 4; k++) x[k] = kept(x[k]);
  }

  EVERY_PAIR for (uint m = 0; m < kTileQuads / 2; m++) makeOutputs(2 * m, true, token, firstToken, firstTarget);
  if (kTileQuads % 2 == 1) makeOutputs(kTileQuads - 1, false, token, firstToken, firstTarget);
}
