// y = activation(x W^T + b) + residual as in linear.comp, for matrix units: x and W are halves, sums are fp32.
// A workgroup computes 128 tokens by 16 * kOutputFragments outputs in steps of 32 input channels, which lie in shared
// memory: texels of the next step are on their way to registers while this one is multiplied. Rows are padded by a texel,
// so that those of a fragment lie in different banks. Weights: [K][N], then bias[N].
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define LEFT_TEXELS (16 * kMatrixRows * kLeftStride)
#define RIGHT_TEXELS (8 * kLinearMatrixTexels * kRightStride)
#define kLeftStride (kLinearMatrixTexels + 1)
#define kRightStride (2 * kOutputFragments + 1)
#include "shaders/common/matrix_tile.glsl"
#include "shaders/common/activation.glsl"
#include "shaders/common/storage.glsl"
#include "shaders/linear/linear.h"
layout(constant_id = 4) const uint kActivation = kActivationNone;
layout(constant_id = 5) const bool kHasResidual = false;
layout(constant_id = 10) const bool kHasAppended = false;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2) uniform samplerBuffer residual;
layout(binding = 3, std430) writeonly buffer Target { STORED4 target[]; };
layout(binding = 4) uniform samplerBuffer appended;
layout(push_constant) uniform Push { LinearParams p; };
#include "shaders/linear/token.glsl"
const uint kTokens = 16 * kMatrixRows, kRowTexels = 2 * kOutputFragments;
const uint kWeightTexels = 8 * kLinearMatrixTexels * kRowTexels;
const uint kSourceFetches = kTokens * kLinearMatrixTexels / kInvocations;
const uint kWeightFetches = (kWeightTexels + kInvocations - 1) / kInvocations;

uvec4 sourceTexel(uint token, uint quad) {
  const uint quads = p.inputChannels / 4, from = min(token, p.tokenEnd - 1);
  const vec4 a = tokenQuad(from, min(quad, quads - 1)), b = tokenQuad(from, min(quad + 1, quads - 1));
  return halves(quad < quads ? a : vec4(0), quad + 1 < quads ? b : vec4(0));
}

uvec4 weightTexel(uint k, uint quad) {
  const uint quads = p.outputChannels / 4, from = min(k, p.inputChannels - 1) * quads;
  return halves(texelFetch(weights, int(from + min(quad, quads - 1))),
                texelFetch(weights, int(from + min(quad + 1, quads - 1))));
}

void finish(uint token, uint quad, vec4 sum) {
  const uint quads = p.outputChannels / 4;
  if (token >= p.tokenEnd || quad >= quads) return;
  vec4 y = activate(kActivation, sum + texelFetch(weights, int(p.inputChannels * quads + quad)));
  if (kHasResidual) y += texelFetch(residual, int(token * p.residual.stride + p.residual.offset + quad));
  target[token * p.target.stride + p.target.offset + quad - p.storeOrigin] = stored4(y);
}

// Tiles of tokens are folded as in tileGroups().
uint tokenTile() { return gl_WorkGroupID.z * gl_NumWorkGroups.y + gl_WorkGroupID.y; }

void main() {
  const uint firstQuad = gl_WorkGroupID.x * 4 * kOutputFragments, firstToken = p.tokenBegin + tokenTile() * kTokens;
  const uint row = firstRow(subgroupIndex()), column = firstColumn(subgroupIndex());
  SUMS(sum, kFragmentRows, kFragmentColumns);
  [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
    [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) CLEAR_SUM(sum[r][c]);

  uvec4 nextX[kSourceFetches], nextW[kWeightFetches];
  const uint kStep = 8 * kLinearMatrixTexels;
  for (uint first = 0; first < p.inputChannels + kStep; first += kStep) {
    if (first > 0) {  // what was fetched in the round before
      barrier();
      [[unroll]] for (uint i = 0; i < kSourceFetches; i++) {
        const uint at = i * kInvocations + gl_LocalInvocationIndex;
        left[at / kLinearMatrixTexels * kLeftStride + at % kLinearMatrixTexels] = nextX[i];
      }
      [[unroll]] for (uint i = 0; i < kWeightFetches; i++) {
        const uint at = i * kInvocations + gl_LocalInvocationIndex;
        if (at < kWeightTexels) right[at / kRowTexels * kRightStride + at % kRowTexels] = nextW[i];
      }
      barrier();
    }
    if (first < p.inputChannels) {
      [[unroll]] for (uint i = 0; i < kSourceFetches; i++) {
        const uint at = i * kInvocations + gl_LocalInvocationIndex;
        nextX[i] = sourceTexel(firstToken + at / kLinearMatrixTexels, first / 4 + at % kLinearMatrixTexels * 2);
      }
      [[unroll]] for (uint i = 0; i < kWeightFetches; i++) {
        const uint at = i * kInvocations + gl_LocalInvocationIndex;
        nextW[i] = weightTexel(first + at / kRowTexels, firstQuad + at % kRowTexels * 2);
      }
    }
    if (first > 0) {
      [[unroll]] for (uint k = 0; k < kLinearMatrixTexels; k += 2) {  // 16 inputs
        LEFT_FRAGMENTS(x, kFragmentRows);
        [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
          LOAD_LEFT(x[r], left, 16 * (row + r) * kLeftStride + k, kLeftStride);
        [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) {
          RIGHT_FRAGMENT(w);
          LOAD_RIGHT(w, right, 8 * k * kRightStride + 2 * (column + c), kRightStride);
          [[unroll]] for (uint r = 0; r < kFragmentRows; r++) MULTIPLY_ADD(x[r], w, sum[r][c]);
        }
      }
    }
  }

  [[unroll]] for (uint r = 0; r < kFragmentRows; r++)
    [[unroll]] for (uint c = 0; c < kFragmentColumns; c++) {
      barrier();
      STORE_SUM(sum[r][c], stored, subgroupIndex() * 64, 4);
      barrier();
      for (uint i = gl_LocalInvocationIndex; i < kSubgroups * 64; i += kInvocations) {
        const uint token = 16 * (firstRow(i / 64) + r) + i % 64 / 4;
        finish(firstToken + token, firstQuad + 4 * (firstColumn(i / 64) + c) + i % 4, storedQuad(i));
      }
    }
}
