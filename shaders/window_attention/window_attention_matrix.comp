// y = softmax(q k^T / sqrt(d) + bias) v over the tokens of each window and head as in window_attention.comp, for matrix units:
// q, k, v, y and the weights, which are at most 1, are halves, sums are fp32. A workgroup computes a window of 8 x 8 of a head, each of
// its four subgroups 16 queries. Pool: q, then k, rows of d channels; in their place, once they are multiplied, scores, a row a query,
// which become weights and then the result; behind them v, transposed. Rows are a texel longer than they need be,
// so that those of a fragment lie in different banks.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/matrix.glsl"
#include "shaders/window_attention/window_attention.h"
layout(constant_id = 1) const uint kHeadChannels = 32;
layout(constant_id = 4) const bool kShifted = false;
layout(binding = 0) uniform usamplerBuffer queries;  // texels of four halves
layout(binding = 1) uniform usamplerBuffer keys;
layout(binding = 2) uniform usamplerBuffer values;
layout(binding = 3) uniform samplerBuffer table;
layout(binding = 4, std430) writeonly buffer Target { uvec2 target[]; };
layout(push_constant) uniform Push { WindowAttentionParams p; };

const uint kWindow = kAttentionMatrixWindow, kTokens = kWindow * kWindow;
const uint kRows = 16, kQuads = kHeadChannels / 4;  // queries of a subgroup; texels of a token's head
const uint kHeadStride = ATTENTION_HEAD_STRIDE(kHeadChannels), kScoreStride = kAttentionScoreStride;
const uint kKeysAt = kTokens * kHeadStride, kValueStride = kAttentionValueStride;
const uint kValuesAt = ATTENTION_VALUES_AT(kHeadChannels), kPoolTexels = kValuesAt + kHeadChannels * kValueStride;
shared uvec4 pool[kPoolTexels];
shared uint regions[kTokens];
shared float highests[kInvocations], totals[kInvocations];  // of an invocation's part of a row of scores
#include "shaders/window_attention/window.glsl"

// A row of scores is shared by lanes that stand side by side.
const uint kParts = kLanes / kRows, kPartQuads = kTokens / 4 / kParts;
uint rowOf() { return subgroupIndex() * kRows + lane() / kParts; }
uint firstOfRow(uint row) { return subgroupIndex() * kLanes + row % kRows * kParts; }  // of `highests` and `totals`

uint pixelOf(uint token) { return pixelOf(corner() + inWindow(token)); }

void loadHead() {
  for (uint i = gl_LocalInvocationIndex; i < kTokens * kQuads / 2; i += kInvocations) {
    const uint token = i / (kQuads / 2), texel = i % (kQuads / 2), pixel = pixelOf(token);
    const int query = texelOf(p.queries, pixel) + int(2 * texel), key = texelOf(p.keys, pixel) + int(2 * texel);
    pool[token * kHeadStride + texel] = uvec4(texelFetch(queries, query).xy, texelFetch(queries, query + 1).xy);
    pool[kKeysAt + token * kHeadStride + texel] = uvec4(texelFetch(keys, key).xy, texelFetch(keys, key + 1).xy);
  }
  // Two tokens' halves of a channel are a word.
  for (uint i = gl_LocalInvocationIndex; i < kTokens / 2 * kQuads; i += kInvocations) {
    const uint pair = i / kQuads, quad = i % kQuads;
    const uvec2 a = texelFetch(values, texelOf(p.values, pixelOf(2 * pair)) + int(quad)).xy;
    const uvec2 b = texelFetch(values, texelOf(p.values, pixelOf(2 * pair + 1)) + int(quad)).xy;
    const uvec2 even = a & 0xFFFFu | b << 16, odd = a >> 16 | b & 0xFFFF0000u;
    const uint channel = kValuesAt + 4 * quad * kValueStride + pair / 4;
    pool[channel][pair % 4] = even.x;
    pool[channel + kValueStride][pair % 4] = odd.x;
    pool[channel + 2 * kValueStride][pair % 4] = even.y;
    pool[channel + 3 * kValueStride][pair % 4] = odd.y;
  }
  stageBiases();
  if (kShifted)
    for (uint i = gl_LocalInvocationIndex; i < kTokens; i += kInvocations) regions[i] = regionOf(corner() + inWindow(i));
}

// q k^T of the subgroup's queries, once all subgroups have read them and the keys.
void score() {
  SUMS(sums, kTokens / 16, 1);
  [[unroll]] for (uint c = 0; c < kTokens / 16; c++) CLEAR_SUM(sums[c][0]);
  [[unroll]] for (uint k = 0; k < kHeadChannels / 8; k += 2) {
    LEFT_FRAGMENT(q);
    LOAD_LEFT(q, pool, subgroupIndex() * kRows * kHeadStride + k, kHeadStride);
    [[unroll]] for (uint c = 0; c < kTokens / 16; c++) {
      RIGHT_FRAGMENT(key);
      LOAD_RIGHT(key, pool, kKeysAt + 16 * c * kHeadStride + k, kHeadStride);
      MULTIPLY_ADD(q, key, sums[c][0]);
    }
  }
  barrier();
  [[unroll]] for (uint c = 0; c < kTokens / 16; c++)
    STORE_SUM(sums[c][0], pool, subgroupIndex() * kRows * kScoreStride + 4 * c, kScoreStride);
}

// Four scores of a row, with their biases and what does not see each other hidden.
vec4 scoresOf(uint row, uint key) {
  const uint bias = firstBias(inWindow(row)) - biasesBehind(inWindow(key));
  vec4 scores = uintBitsToFloat(pool[row * kScoreStride + key / 4]) * (inversesqrt(float(kHeadChannels)) * kLog2E) +
                vec4(biases[bias], biases[bias - 1], biases[bias - 2], biases[bias - 3]);
  if (kShifted)
    [[unroll]] for (uint j = 0; j < 4; j++)
      if (regions[key + j] != regions[row]) scores[j] = kHidden;
  return scores;
}

float highestOf(vec4 v) { return max(max(v.x, v.y), max(v.z, v.w)); }

// Scores to weights, of which the largest of a row is 1, and the sums of these. A lane that has a row for itself reads it
// twice: small subgroups have few registers.
void takeSoftmax() {
  const uint row = rowOf(), part = lane() % kParts, at = row * kScoreStride;
  float highest = kLowest, total = 0;
  if (kParts == 1) {
    for (uint i = 0; i < kPartQuads; i++) {
      const vec4 scores = scoresOf(row, 4 * i);
      pool[at + i] = floatBitsToUint(scores);
      highest = max(highest, highestOf(scores));
    }
    for (uint i = 0; i < kPartQuads; i += 2) {
      const vec4 a = exp2(uintBitsToFloat(pool[at + i]) - highest), b = exp2(uintBitsToFloat(pool[at + i + 1]) - highest);
      total += a.x + a.y + a.z + a.w + b.x + b.y + b.z + b.w;
      pool[at + i / 2] = roundedHalves(a, b);
    }
    totals[subgroupIndex() * kLanes + lane()] = total;
    return;
  }
  vec4 weights[kPartQuads];
  [[unroll]] for (uint i = 0; i < kPartQuads; i++) {
    weights[i] = scoresOf(row, 4 * (part * kPartQuads + i));
    highest = max(highest, highestOf(weights[i]));
  }
  highests[subgroupIndex() * kLanes + lane()] = highest;
  SUBGROUP_BARRIER;
  [[unroll]] for (uint i = 0; i < kParts; i++) highest = max(highest, highests[firstOfRow(row) + i]);
  [[unroll]] for (uint i = 0; i < kPartQuads; i++) {
    weights[i] = exp2(weights[i] - highest);
    total += weights[i].x + weights[i].y + weights[i].z + weights[i].w;
  }
  totals[subgroupIndex() * kLanes + lane()] = total;
  [[unroll]] for (uint i = 0; i < kPartQuads; i += 2)
    pool[at + (part * kPartQuads + i) / 2] = roundedHalves(weights[i], weights[i + 1]);
}

// The weights times v, in place of the weights.
void weighValues() {
  const uint row = subgroupIndex() * kRows * kScoreStride;
  SUMS(sums, kHeadChannels / 16, 1);
  [[unroll]] for (uint c = 0; c < kHeadChannels / 16; c++) CLEAR_SUM(sums[c][0]);
  [[unroll]] for (uint k = 0; k < kTokens / 8; k += 2) {
    LEFT_FRAGMENT(weight);
    LOAD_LEFT(weight, pool, row + k, kScoreStride);
    [[unroll]] for (uint c = 0; c < kHeadChannels / 16; c++) {
      RIGHT_FRAGMENT(value);
      LOAD_RIGHT(value, pool, kValuesAt + 16 * c * kValueStride + k, kValueStride);
      MULTIPLY_ADD(weight, value, sums[c][0]);
    }
  }
  SUBGROUP_BARRIER;
  [[unroll]] for (uint c = 0; c < kHeadChannels / 16; c++) STORE_SUM(sums[c][0], pool, row + 4 * c, kScoreStride);
}

void main() {
  loadHead();
  barrier();
  score();
  SUBGROUP_BARRIER;
  takeSoftmax();
  SUBGROUP_BARRIER;
  weighValues();
  SUBGROUP_BARRIER;
  for (uint i = lane(); i < kRows * kQuads; i += kLanes) {
    const uint row = subgroupIndex() * kRows + i / kQuads, quad = i % kQuads, pixel = pixelOf(row);
    const uint y = pixel / p.width;
    if (y < p.rowBegin || y >= p.rowEnd) continue;
    float total = 0;
    [[unroll]] for (uint part = 0; part < kParts; part++) total += totals[firstOfRow(row) + part];
    target[uint(texelOf(p.target, pixel)) + quad - p.storeOrigin] =
        packHalf4(uintBitsToFloat(pool[row * kScoreStride + quad]) / total);
  }
}
