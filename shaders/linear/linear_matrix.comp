// y = activation(x W^T + b) + residual as in linear.comp, for matrix units: x and W are halves, sums are fp32.
// A workgroup computes 128 tokens by 16 * kOutputFragments outputs in steps of 32 input channels, which lie in shared
// memory: texels of the next step are on their way to registers while this one is multiplied. Rows and columns are padded
// by a texel, so that those of a fragment lie in different banks. Weights: [N][K], whole tiles of a workgroup's outputs and
// steps, zero behind the last, then bias[N].
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define LEFT_TEXELS (16 * kMatrixRows * kStride)
#define RIGHT_TEXELS (16 * kOutputFragments * kStride)
#define kStride (kLinearMatrixTexels + 1)
#include "shaders/common/matrix_tile.glsl"
#include "shaders/common/activation.glsl"
#include "shaders/common/storage.glsl"
#include "shaders/linear/linear.h"
layout(constant_id = 4) const uint kActivation = kActivationNone;
layout(constant_id = 5) const bool kHasResidual = false;
layout(constant_id = 10) const bool kHasAppended = false;
layout(constant_id = 11) const bool kWholeSteps = false;  // of input channels
layout(binding = 0) uniform usamplerBuffer source;        // texels of four halves
layout(binding = 1, std430) readonly buffer Weights { uvec4 weights[]; };
layout(binding = 2) uniform samplerBuffer residual;
layout(binding = 3, std430) writeonly buffer Target { STORED4 target[]; };
layout(binding = 4) uniform usamplerBuffer appended;
layout(push_constant) uniform Push { LinearParams p; };
const uint kTokens = 16 * kMatrixRows, kOutputs = 16 * kOutputFragments, kStep = 8 * kLinearMatrixTexels;
const uint kWeightTexels = kOutputs * kLinearMatrixTexels;
const uint kSourceFetches = kTokens * kLinearMatrixTexels / kInvocations;
const uint kWeightFetches = (kWeightTexels + kInvocations - 1) / kInvocations;

uint weightRowTexels() { return (p.inputChannels + kStep - 1) / kStep * kLinearMatrixTexels; }

// Four input channels of a token, whose texels of the two sources begin there.
uvec2 quadAt(uvec2 first, uint quad) {
  if (!kWholeSteps && quad >= p.inputChannels / 4) return uvec2(0);
  if (kHasAppended && quad >= p.sourceChannels / 4)
    return texelFetch(appended, int(first.y + quad - p.sourceChannels / 4)).xy;
  return texelFetch(source, int(first.x + quad)).xy;
}

// Tiles of tokens are folded as in tileGroups().
uint firstToken() { return p.tokenBegin + (gl_WorkGroupID.z * gl_NumWorkGroups.y + gl_WorkGroupID.y) * kTokens; }
uint firstQuad() { return gl_WorkGroupID.x * kOutputs / 4; }

vec4 biasOf(uint quad) {
  const uvec4 texel = weights[gl_NumWorkGroups.x * kOutputs * weightRowTexels() + quad / 2];
  const uvec2 four = quad % 2 == 0 ? texel.xy : texel.zw;
  return vec4(unpackHalf2x16(four.x), unpackHalf2x16(four.y));
}

bool isStored(uint token, uint quad) { return token < p.tokenEnd && quad < p.outputChannels / 4; }

vec4 residualOf(uint token, uint quad) {
  return isStored(token, quad) ? texelFetch(residual, int(token * p.residual.stride + p.residual.offset + quad)) : vec4(0);
}

void finish(uint token, uint quad, vec4 sum, vec4 added) {
  if (!isStored(token, quad)) return;
  vec4 y = activate(kActivation, sum);
  if (kHasResidual) y += added;
  target[token * p.target.stride + p.target.offset + quad - p.storeOrigin] = stored4(y);
}

void main() {
  const uint row = firstRow(subgroupIndex()), column = firstColumn(subgroupIndex());
  SUMS(sum, kFragmentRows, kFragmentColumns);
  [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
    [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) CLEAR_SUM(sum[r][c]);
  // An invocation fetches the same texel of a step for each of its tokens and outputs.
  const uint texel = gl_LocalInvocationIndex % kLinearMatrixTexels, line = gl_LocalInvocationIndex / kLinearMatrixTexels;
  const uint kLines = kInvocations / kLinearMatrixTexels, weightRow = weightRowTexels();
  uvec2 from[kSourceFetches];
  [[unroll]] for (uint i = 0; i < kSourceFetches; i++) {
    const uint token = min(firstToken() + i * kLines + line, p.tokenEnd - 1);
    from[i] = token * uvec2(p.source.stride, p.appended.stride) + uvec2(p.source.offset, p.appended.offset);
  }
  uvec4 nextX[kSourceFetches], nextW[kWeightFetches];
  for (uint first = 0; first < p.inputChannels + kStep; first += kStep) {
    if (first > 0) {  // what was fetched in the round before
      barrier();
      [[unroll]] for (uint i = 0; i < kSourceFetches; i++) pool[(i * kLines + line) * kStride + texel] = nextX[i];
      [[unroll]] for (uint i = 0; i < kWeightFetches; i++)
        if (i * kLines + line < kOutputs) pool[kRightAt + (i * kLines + line) * kStride + texel] = nextW[i];
      barrier();
    }
    if (first < p.inputChannels) {
      const uint quad = first / 4 + 2 * texel;
      [[unroll]] for (uint i = 0; i < kSourceFetches; i++)
        nextX[i] = uvec4(quadAt(from[i], quad), quadAt(from[i], quad + 1));
      [[unroll]] for (uint i = 0; i < kWeightFetches; i++)
        if (i * kLines + line < kOutputs)
          nextW[i] = weights[(gl_WorkGroupID.x * kOutputs + i * kLines + line) * weightRow + first / 8 + texel];
    }
    if (first > 0) {
      [[unroll]] for (uint k = 0; k < kLinearMatrixTexels; k += 2) {  // 16 inputs
        LEFT_FRAGMENTS(x, kFragmentRows);
        [[unroll]] for (uint r = 0; r < kFragmentRows; r++) LOAD_LEFT(x[r], pool, 16 * (row + r) * kStride + k, kStride);
        [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) {
          RIGHT_FRAGMENT(w);
          LOAD_RIGHT(w, pool, kRightAt + 16 * (column + c) * kStride + k, kStride);
          [[unroll]] for (uint r = 0; r < kFragmentRows; r++) MULTIPLY_ADD(x[r], w, sum[r][c]);
        }
      }
    }
  }
  // What is added to the sums is all on its way before the first of them is stored.
#define TOKEN(r, inRow) (firstToken() + 16 * (row + r) + inRow)
#define QUAD(c, inColumn) (firstQuad() + 4 * (column + c) + inColumn)
  vec4 bias[kFragmentColumns], added[kFragmentRows][kFragmentColumns][kQuadsOfLane];
  [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) {
    bias[c] = biasOf(QUAD(c, lane() % 4));
    if (kHasResidual)
      [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
        [[unroll]] for (uint i = 0; i < kQuadsOfLane; i++)
          added[r][c][i] = residualOf(TOKEN(r, (i * kLanes + lane()) / 4), QUAD(c, lane() % 4));
  }
  barrier();
  [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
    [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) {
#define FINISH(i, inRow, inColumn, value) \
  finish(TOKEN(r, inRow), QUAD(c, inColumn), value + bias[c], added[r][c][i])
      EACH_QUAD(sum[r][c], FINISH);
    }
}
