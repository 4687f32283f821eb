// u = t + WMSA(LN(t)); y = u + MLP(LN(u)), or the 1x1 convolution of that: a Swin layer of one window, which is a workgroup's.
// Halves are multiplied and stored, all sums are fp32. Pool: the tokens t, LN(t), u, LN(u) and y in turn; [q k] of a head,
// whose q becomes softmax(..) v, and its v, transposed; scores of kScoreRows queries, which become weights; in place of
// these the hidden features. Weights: tiles [n][k] of 16 x 16, all of them right operands. A map has for each 16 outputs a tile
// of which the first two k add up to the bias, and those for all inputs: qkv head by head (scaled for exp2), bias and mask of
// the scores by window class, head and query, proj, fc1, fc2, grow (no bias), the identity.
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
const uint kTokens = kSwinTokens;
// Subgroups share out the rows of fragments of the window, and beside each other the columns.
const uint kRowGroups = kSubgroups >= 8 ? 4 : 2, kColumnGroups = kSubgroups / kRowGroups;
const uint kTokenRows = kTokens / 16, kRows = kTokenRows / kRowGroups;  // of fragments: of the window, of a subgroup
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
const uint kIdentityAt = kGrowAt + (kGrows ? kOutputs / 16 * kGrowColumn : 0);
// Columns that a subgroup makes at once, but for those whose sums it keeps.
#ifdef XRDS_MATRIX_SOFTWARE
const uint kMostColumns = 1;  // drivers take their time to compile more
#else
const uint kMostColumns = 4;
#endif
const uint kHeadColumns = 3 * kHeadChannels / 16;
shared uvec4 pool[kPoolTexels];
#include "shaders/swin_layer/window.glsl"
#include "shaders/swin_layer/columns.glsl"

float asHalf(float v) { return clamp(v, -kLargestHalf, kLargestHalf); }
float gelu(float v) { return asHalf(activate(kActivationGelu, vec4(v)).x); }

void mapHead(uint head) {
  const uint count = min(COLUMNS_OF(kHeadColumns), kMostColumns), tile = head * kHeadColumns * kTokenColumn;
  for (uint first = 0; first < kHeadColumns; first += count * kColumnGroups) {
    const uint tiles = tile + first * kTokenColumn;
    SUMS(sums, kMostColumns, kRows);
    EACH_COLUMN(j, count, kHeadColumns - first) TAKE_BIAS(sums[j], tiles + COLUMN(j) * kTokenColumn)
    ADD_PRODUCTS(sums, count, kHeadColumns - first, 0, kTokenStride, tiles + kTile, kTokenColumn, kChannels)
    EACH_COLUMN(j, count, kHeadColumns - first) {
      const uint column = first + COLUMN(j);
      if (column < kHeadChannels / 8) {
        STORE_ROWS(asHalf, sums[j], kHeadAt + 2 * column, kHeadStride)
      } else
        FOR_ROWS {
          APPLY(asHalf, sums[j][r]);
          const uint at = kValuesAt + 16 * (column - kHeadChannels / 8) * kValueStride + 2 * (firstRow() + r);
          STORE_HALVES_TRANSPOSED(sums[j][r], pool, at, kValueStride);
        }
    }
  }
}

// Of the queries from firstQuery on.
void score(uint head, uint firstQuery) {
  for (uint i = subgroupIndex(); i < kScoreRows / 16 * kTokenRows; i += kSubgroups) {
    const uint row = firstQuery + 16 * (i / kTokenRows), column = i % kTokenRows;
    SUM(sum);
    CLEAR_SUM(sum);
    for (uint k = 0; k < kHeadChannels / 8; k += 2) {
      LEFT_FRAGMENT(q);
      LOAD_LEFT(q, pool, kHeadAt + row * kHeadStride + k, kHeadStride);
      RIGHT_FRAGMENT(keys);
      LOAD_RIGHT(keys, pool, kHeadAt + 16 * column * kHeadStride + kHeadChannels / 8 + k, kHeadStride);
      MULTIPLY_ADD(q, keys, sum);
    }
    STORE_SUM(sum, pool, kScoresAt + 16 * (i / kTokenRows) * kScoreStride + 4 * column, kScoreStride);
  }
}

void weighValues(uint firstQuery) {
  const uint columns = kHeadChannels / 16;
  for (uint i = subgroupIndex(); i < kScoreRows / 16 * columns; i += kSubgroups) {
    const uint row = 16 * (i / columns), column = i % columns;
    SUM(sum);
    CLEAR_SUM(sum);
    for (uint k = 0; k < kTokenRows; k++) {
      LEFT_FRAGMENT(share);
      LOAD_LEFT(share, pool, kScoresAt + row * kScoreStride + 2 * k, kScoreStride);
      RIGHT_FRAGMENT(values);
      LOAD_RIGHT(values, pool, kValuesAt + 16 * column * kValueStride + 2 * k, kValueStride);
      MULTIPLY_ADD(share, values, sum);
    }
    STORE_HALVES(sum, pool, kHeadAt + (firstQuery + row) * kHeadStride + 2 * column, kHeadStride);
  }
}

void makeHidden(uint firstColumn) {
  const uint columns = kHiddenPart / 16, count = min(COLUMNS_OF(columns), kMostColumns);
  for (uint first = 0; first < columns; first += count * kColumnGroups) {
    const uint tiles = kFc1At + (firstColumn + first) * kTokenColumn;
    SUMS(sums, kMostColumns, kRows);
    EACH_COLUMN(j, count, columns - first) TAKE_BIAS(sums[j], tiles + COLUMN(j) * kTokenColumn)
    ADD_PRODUCTS(sums, count, columns - first, 0, kTokenStride, tiles + kTile, kTokenColumn, kChannels)
    EACH_COLUMN(j, count, columns - first)
      STORE_ROWS(gelu, sums[j], kHiddenAt + 2 * (first + COLUMN(j)), kHiddenStride)
  }
}

void main() {
  const uint columns = kChannels / 16, outColumns = kOutputs / 16;
  const uint count = COLUMNS_OF(columns), outCount = COLUMNS_OF(outColumns);
  loadTokens();
  barrier();
  SUMS(u, COLUMNS_OF(kChannels / 16), kRows);
  EACH_COLUMN(j, count, columns) {
    TAKE_BIAS(u[j], kProjAt + COLUMN(j) * kTokenColumn)
    ADD_TOKENS(u[j], COLUMN(j))
  }
  normalizeTokens();
  for (uint head = 0; head < kHeads; head++) {
    barrier();
    mapHead(head);
    barrier();
    for (uint query = 0; query < kTokens; query += kScoreRows) {
      score(head, query);
      barrier();
      takeSoftmax(kBiasAt + ((windowClass() * kHeads + head) * kTokens + query) * kTokens / 8);
      barrier();
      weighValues(query);
      barrier();
    }
    const uint tiles = kProjAt + (1 + head * kHeadChannels / 16) * kTile;
    ADD_PRODUCTS(u, count, columns, kHeadAt, kHeadStride, tiles, kTokenColumn, kHeadChannels)
  }
  EACH_COLUMN(j, count, columns) STORE_ROWS(asHalf, u[j], 2 * COLUMN(j), kTokenStride)
  barrier();
  SUMS(y, COLUMNS_OF(kOutputs / 16), kRows);
  EACH_COLUMN(j, outCount, outColumns) {
    TAKE_BIAS(y[j], kFc2At + COLUMN(j) * kHiddenColumn)
    if (!kGrows) ADD_TOKENS(y[j], COLUMN(j))
  }
  if (kGrows) ADD_PRODUCTS(y, outCount, outColumns, 0, kTokenStride, kGrowAt, kGrowColumn, kChannels)
  normalizeTokens();
  for (uint first = 0; first < kHidden / 16; first += kHiddenPart / 16) {
    barrier();
    makeHidden(first);
    barrier();
    const uint tiles = kFc2At + (1 + first) * kTile;
    ADD_PRODUCTS(y, outCount, outColumns, kHiddenAt, kHiddenStride, tiles, kHiddenColumn, kHiddenPart)
  }
  barrier();
  EACH_COLUMN(j, outCount, outColumns) STORE_ROWS(asHalf, y[j], 2 * COLUMN(j), kTokenStride)
  barrier();
  storeTokens();
}
