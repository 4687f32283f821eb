// u = t + WMSA(LN(t)); y = u + MLP(LN(u)), or the 1x1 convolution of that: a Swin layer of one window, which is a workgroup's.
// Halves are multiplied and stored, all sums are fp32. Pool: the tokens t, LN(t), u, LN(u) and y in turn; [q k] of a head,
// whose q becomes softmax(..) v, and its v, transposed; scores of kScoreRows queries, which become weights; in place of
// these the hidden features. Weights: tiles of 16 x 16. A map has for each 16 outputs the bias, in equal rows, and tiles
// [n][k] for all inputs: qkv head by head (scaled for exp2), bias and mask of the scores by window class, head and query,
// proj, fc1, fc2, grow (no bias).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/matrix.glsl"
#include "shaders/common/activation.glsl"
#include "shaders/swin_layer/swin_layer.h"
layout(constant_id = 1) const uint kChannels = 64;
layout(constant_id = 2) const uint kHeadChannels = 32;
layout(constant_id = 3) const uint kHidden = 128;
layout(constant_id = 4) const uint kOutputs = 64;
layout(constant_id = 5) const bool kGrows = true;
layout(constant_id = 10) const uint kScoreRows = 32;
layout(constant_id = 11) const uint kHiddenPart = 128;  // hidden features at a time
layout(constant_id = 12) const uint kPoolTexels = 1;
layout(constant_id = 13) const bool kShifted = false;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1, std430) readonly buffer Weights { uvec4 weights[]; };
layout(binding = 2, std430) writeonly buffer Target { uvec2 target[]; };
layout(push_constant) uniform Push { SwinLayerParams p; };
const uint kTokens = kSwinTokens, kRows = kTokens / 16;  // of fragments
// Rows of the pool are a texel longer than they need be, so that those of a fragment lie in different banks.
const uint kTokenStride = kChannels / 8 + 1, kHeadStride = kHeadChannels / 4 + 1, kScoreStride = kTokens / 4 + 1;
const uint kHiddenStride = kHiddenPart / 8 + 1;
const uint kValueStride = kTokens / 8 + 1, kHeadAt = kTokens * kTokenStride, kValuesAt = kHeadAt + kTokens * kHeadStride;
const uint kScoresAt = kValuesAt + kHeadChannels * kValueStride, kHiddenAt = kHeadAt;
const uint kTile = 32, kHeads = kChannels / kHeadChannels, kBiasTexels = kTokens * kTokens / 8;  // of a head
const uint kTokenColumn = (1 + kChannels / 16) * kTile, kHiddenColumn = (1 + kHidden / 16) * kTile;
const uint kBiasAt = 3 * kChannels / 16 * kTokenColumn;
const uint kProjAt = kBiasAt + (kShifted ? 4 : 1) * kHeads * kBiasTexels;
const uint kFc1At = kProjAt + kChannels / 16 * kTokenColumn, kFc2At = kFc1At + kHidden / 16 * kTokenColumn;
const uint kGrowAt = kFc2At + kOutputs / 16 * kHiddenColumn, kGrowColumn = kChannels / 16 * kTile;
const uint kProjColumns = (kChannels / 16 + kSubgroups - 1) / kSubgroups;  // of a subgroup: every kSubgroups-th
const uint kOutColumns = (kOutputs / 16 + kSubgroups - 1) / kSubgroups;
shared uvec4 pool[kPoolTexels];
#include "shaders/swin_layer/window.glsl"

// A column of 16 outputs for all tokens is a subgroup's, in sums of kRows fragments; each takes every kSubgroups-th.
#define COLUMN(j) ((j) * kSubgroups + subgroupIndex())
#define EACH_COLUMN(j, count, total) [[unroll]] for (uint j = 0; j < (count); j++) if (COLUMN(j) < (total))
#define FOR_ROWS [[unroll]] for (uint r = 0; r < kRows; r++)
#define TAKE_BIAS(sums, tileAt) FOR_ROWS LOAD_SUM(sums[r], weights, tileAt, 2);
#define ADD_TOKENS(sums, column)                                                         \
  FOR_ROWS {                                                                            \
    SUM(t);                                                                             \
    LOAD_SUM(t, pool, 16 * r * kTokenStride + 2 * (column), kTokenStride);              \
    ADD_SUM(sums[r], t);                                                                \
  }
// Rows of the pool times the tiles of the column.
#define ADD_PRODUCTS(sums, leftAt, leftStride, tileAt, depth)                           \
  for (uint k = 0; k < (depth) / 16; k++) {                                             \
    RIGHT_FRAGMENT(w);                                                                  \
    LOAD_RIGHT(w, weights, (tileAt) + k * kTile, 2);                                    \
    FOR_ROWS {                                                                          \
      LEFT_FRAGMENT(x);                                                                 \
      LOAD_LEFT(x, pool, (leftAt) + 16 * r * (leftStride) + 2 * k, leftStride);         \
      MULTIPLY_ADD(x, w, sums[r]);                                                      \
    }                                                                                   \
  }
#define STORE_ROWS(function, sums, at, stride)                                          \
  FOR_ROWS {                                                                            \
    APPLY(function, sums[r]);                                                           \
    STORE_HALVES(sums[r], pool, (at) + 16 * r * (stride), stride);                      \
  }

float asHalf(float v) { return clamp(v, -kLargestHalf, kLargestHalf); }
float gelu(float v) { return asHalf(activate(kActivationGelu, vec4(v)).x); }

void mapHead(uint head) {
  const uint columns = 3 * kHeadChannels / 16;
  for (uint j = subgroupIndex(); j < columns; j += kSubgroups) {
    const uint tile = (head * columns + j) * kTokenColumn;
    SUMS(sums, 1, kRows);
    TAKE_BIAS(sums[0], tile)
    ADD_PRODUCTS(sums[0], 0, kTokenStride, tile + kTile, kChannels)
    if (j < kHeadChannels / 8) {
      STORE_ROWS(asHalf, sums[0], kHeadAt + 2 * j, kHeadStride)
    } else
      FOR_ROWS {
        APPLY(asHalf, sums[0][r]);
        STORE_HALVES_TRANSPOSED(sums[0][r], pool, kValuesAt + 16 * (j - kHeadChannels / 8) * kValueStride + 2 * r, kValueStride);
      }
  }
}

// Of the queries from firstRow on.
void score(uint head, uint firstRow) {
  for (uint i = subgroupIndex(); i < kScoreRows / 16 * kRows; i += kSubgroups) {
    const uint row = firstRow + 16 * (i / kRows), column = i % kRows;
    SUM(sum);
    CLEAR_SUM(sum);
    for (uint k = 0; k < kHeadChannels / 8; k += 2) {
      LEFT_FRAGMENT(q);
      LOAD_LEFT(q, pool, kHeadAt + row * kHeadStride + k, kHeadStride);
      RIGHT_FRAGMENT(keys);
      LOAD_RIGHT(keys, pool, kHeadAt + 16 * column * kHeadStride + kHeadChannels / 8 + k, kHeadStride);
      MULTIPLY_ADD(q, keys, sum);
    }
    STORE_SUM(sum, pool, kScoresAt + 16 * (i / kRows) * kScoreStride + 4 * column, kScoreStride);
  }
}

void weighValues(uint firstRow) {
  const uint columns = kHeadChannels / 16;
  for (uint i = subgroupIndex(); i < kScoreRows / 16 * columns; i += kSubgroups) {
    const uint row = 16 * (i / columns), column = i % columns;
    SUM(sum);
    CLEAR_SUM(sum);
    for (uint k = 0; k < kRows; k++) {
      LEFT_FRAGMENT(share);
      LOAD_LEFT(share, pool, kScoresAt + row * kScoreStride + 2 * k, kScoreStride);
      RIGHT_FRAGMENT(values);
      LOAD_RIGHT(values, pool, kValuesAt + 16 * column * kValueStride + 2 * k, kValueStride);
      MULTIPLY_ADD(share, values, sum);
    }
    STORE_HALVES(sum, pool, kHeadAt + (firstRow + row) * kHeadStride + 2 * column, kHeadStride);
  }
}

void makeHidden(uint firstColumn) {
  for (uint j = subgroupIndex(); j < kHiddenPart / 16; j += kSubgroups) {
    const uint tile = kFc1At + (firstColumn + j) * kTokenColumn;
    SUMS(sums, 1, kRows);
    TAKE_BIAS(sums[0], tile)
    ADD_PRODUCTS(sums[0], 0, kTokenStride, tile + kTile, kChannels)
    STORE_ROWS(gelu, sums[0], kHiddenAt + 2 * j, kHiddenStride)
  }
}

void main() {
  loadTokens();
  barrier();
  SUMS(u, kProjColumns, kRows);
  EACH_COLUMN(j, kProjColumns, kChannels / 16) {
    TAKE_BIAS(u[j], kProjAt + COLUMN(j) * kTokenColumn)
    ADD_TOKENS(u[j], COLUMN(j))
  }
  normalizeTokens();
  for (uint head = 0; head < kHeads; head++) {
    barrier();
    mapHead(head);
    barrier();
    for (uint row = 0; row < kTokens; row += kScoreRows) {
      score(head, row);
      barrier();
      takeSoftmax(kBiasAt + ((windowClass() * kHeads + head) * kTokens + row) * kTokens / 8);
      barrier();
      weighValues(row);
      barrier();
    }
    const uint firstTile = 1 + head * kHeadChannels / 16;
    EACH_COLUMN(j, kProjColumns, kChannels / 16)
      ADD_PRODUCTS(u[j], kHeadAt, kHeadStride, kProjAt + COLUMN(j) * kTokenColumn + firstTile * kTile, kHeadChannels)
  }
  EACH_COLUMN(j, kProjColumns, kChannels / 16) STORE_ROWS(asHalf, u[j], 2 * COLUMN(j), kTokenStride)
  barrier();
  SUMS(y, kOutColumns, kRows);
  EACH_COLUMN(j, kOutColumns, kOutputs / 16) {
    TAKE_BIAS(y[j], kFc2At + COLUMN(j) * kHiddenColumn)
    if (kGrows)
      ADD_PRODUCTS(y[j], 0, kTokenStride, kGrowAt + COLUMN(j) * kGrowColumn, kChannels)
    else
      ADD_TOKENS(y[j], COLUMN(j))
  }
  normalizeTokens();
  for (uint first = 0; first < kHidden / 16; first += kHiddenPart / 16) {
    barrier();
    makeHidden(first);
    barrier();
    EACH_COLUMN(j, kOutColumns, kOutputs / 16)
      ADD_PRODUCTS(y[j], kHiddenAt, kHiddenStride, kFc2At + COLUMN(j) * kHiddenColumn + (1 + first) * kTile, kHiddenPart)
  }
  barrier();
  EACH_COLUMN(j, kOutColumns, kOutputs / 16) STORE_ROWS(asHalf, y[j], 2 * COLUMN(j), kTokenStride)
  barrier();
  storeTokens();
}
