// y = activation(x W^T + b) + residual as in linear.comp, for GPUs.
// A workgroup computes kThreadTokens * kRows tokens by 4 * kColumns outputs, an invocation (column, row) four outputs of
// the tokens row, row + kRows, ... Steps of 16 input channels lie in shared memory: texels of the next step are on their
// way to registers while this one is multiplied. What is read behind the last token, input or output counts for nothing.
// Weights: [K][N], then bias[N]. Any subgroup size; every output is summed in the same order wherever it lies. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/activation.glsl"
#include "shaders/common/storage.glsl"
#include "shaders/linear/linear.h"
layout(local_size_x_id = 0, local_size_y_id = 1) in;
layout(constant_id = 2) const uint kThreadTokens = 4;
layout(constant_id = 3) const uint kActivation = kActivationNone;
layout(constant_id = 4) const bool kHasResidual = false;
layout(constant_id = 5) const bool kHasAppended = false;
// Sizes of arrays have constants of their own: Metal's cannot come from gl_WorkGroupSize before SPIRV-Cross of August 2025.
layout(constant_id = 6) const uint kColumns = 1;  // of the workgroup, as is the next
layout(constant_id = 7) const uint kRows = 1;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer weights;
layout(binding = 2) uniform samplerBuffer residual;
layout(binding = 3, std430) writeonly buffer Target { STORED4 target[]; };
layout(binding = 4) uniform samplerBuffer appended;
layout(push_constant) uniform Push { LinearParams p; };
#include "shaders/linear/token.glsl"

const uint kInvocations = kColumns * kRows, kTokens = kThreadTokens * kRows;
const uint kQuads = kLinearTileInputs / 4;
const uint kSourceTexels = kTokens * kQuads, kWeightTexels = kLinearTileInputs * kColumns;
const uint kSourceFetches = (kSourceTexels + kInvocations - 1) / kInvocations;
const uint kWeightFetches = (kWeightTexels + kInvocations - 1) / kInvocations;
shared vec4 x[kSourceTexels];  // [token][quad]
shared vec4 w[kWeightTexels];  // [input][output quad]

// Tiles of tokens are folded as in tileGroups().
uint tokenTile() { return gl_WorkGroupID.z * gl_NumWorkGroups.y + gl_WorkGroupID.y; }

void main() {
  const uint outputQuads = p.outputChannels / 4, inputQuads = p.inputChannels / 4;
  const uint column = gl_LocalInvocationID.x, row = gl_LocalInvocationID.y;
  const uint firstQuad = gl_WorkGroupID.x * kColumns, firstToken = p.tokenBegin + tokenTile() * kTokens;
  const uint quad = firstQuad + column, lastQuad = outputQuads - 1;

  vec4 nextX[kSourceFetches], nextW[kWeightFetches], sum[kThreadTokens];
  const vec4 bias = texelFetch(weights, int(p.inputChannels * outputQuads + min(quad, lastQuad)));
  [[unroll]] for (uint t = 0; t < kThreadTokens; t++) sum[t] = bias;

  for (uint first = 0; first < inputQuads + kQuads; first += kQuads) {
    if (first > 0) {  // what was fetched in the round before
      barrier();
      [[unroll]] for (uint i = 0; i < kSourceFetches; i++) {
        const uint at = i * kInvocations + gl_LocalInvocationIndex;
        if (at < kSourceTexels) x[at] = nextX[i];
      }
      [[unroll]] for (uint i = 0; i < kWeightFetches; i++) {
        const uint at = i * kInvocations + gl_LocalInvocationIndex;
        if (at < kWeightTexels) w[at] = nextW[i];
      }
      barrier();
    }
    if (first < inputQuads) {
      [[unroll]] for (uint i = 0; i < kSourceFetches; i++) {
        const uint at = i * kInvocations + gl_LocalInvocationIndex, k = first + at % kQuads;
        const uint token = min(firstToken + at / kQuads, p.tokenEnd - 1);
        const vec4 texel = tokenQuad(token, min(k, inputQuads - 1));
        nextX[i] = k < inputQuads ? texel : vec4(0);
      }
      [[unroll]] for (uint i = 0; i < kWeightFetches; i++) {
        const uint at = i * kInvocations + gl_LocalInvocationIndex;
        const uint k = min(4 * first + at / kColumns, p.inputChannels - 1);
        nextW[i] = texelFetch(weights, int(k * outputQuads + min(firstQuad + at % kColumns, lastQuad)));
      }
    }
    if (first > 0) {
      [[unroll]] for (uint q = 0; q < kQuads; q++) {
        vec4 columns[4];  // the weights of input channel 4 q + i
        [[unroll]] for (uint i = 0; i < 4; i++) columns[i] = w[(4 * q + i) * kColumns + column];
        [[unroll]] for (uint t = 0; t < kThreadTokens; t++) {
          const vec4 inputs = x[(t * kRows + row) * kQuads + q];
          [[unroll]] for (uint i = 0; i < 4; i++) sum[t] += columns[i] * inputs[i];
        }
      }
    }
  }

  if (quad > lastQuad) return;
  [[unroll]] for (uint t = 0; t < kThreadTokens; t++) {
    const uint token = firstToken + t * kRows + row;
    if (token >= p.tokenEnd) break;
    vec4 y = activate(kActivation, sum[t]);
    if (kHasResidual) y += texelFetch(residual, int(token * p.residual.stride + p.residual.offset + quad));
    target[token * p.target.stride + p.target.offset + quad - p.storeOrigin] = stored4(y);
  }
}
