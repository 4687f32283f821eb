// How a workgroup of the matrix kernels of `linear` and `conv3x3` shares 16 kMatrixRows tokens by 16 kOutputFragments outputs
// among its subgroups. The kernel defines LEFT_TEXELS and RIGHT_TEXELS.
#ifndef XRDS_SHADERS_COMMON_MATRIX_TILE_GLSL
#define XRDS_SHADERS_COMMON_MATRIX_TILE_GLSL
#include "shaders/common/matrix.glsl"

layout(constant_id = 1) const uint kOutputFragments = 4;  // the workgroup's outputs, in sixteens
layout(constant_id = 2) const uint kFragmentRows = 2;     // of a subgroup, of the kMatrixRows of the workgroup
layout(constant_id = 3) const uint kFragmentColumns = 2;  // of a subgroup
const uint kRowGroups = kMatrixRows / kFragmentRows;
// Rows of the left operands, columns of the right ones; in their place, in the end, a sum of each subgroup, in rows of
// four texels.
const uint kSumTexels = 64, kRightAt = LEFT_TEXELS, kStaged = LEFT_TEXELS + RIGHT_TEXELS, kSums = kSubgroups * kSumTexels;
const uint kQuadsOfLane = kLanes < kSumTexels ? kSumTexels / kLanes : 1;  // of a fragment
shared uvec4 pool[kStaged > kSums ? kStaged : kSums];

// Takes a fragment of sums of each subgroup apart: FINISH(i, row, quad, sum) for each four outputs of a row of 16, i counting
// those of the lane, whose quad is lane() % 4. Only the subgroup itself sees its place.
#define EACH_QUAD(sums, FINISH)                                                          \
  STORE_SUM(sums, pool, subgroupIndex() * kSumTexels, 4);                                \
  SUBGROUP_BARRIER;                                                                      \
  [[unroll]] for (uint i = 0; i < kQuadsOfLane; i++) {                                   \
    const uint at = i * kLanes + lane();                                                 \
    FINISH(i, at / 4, at % 4, uintBitsToFloat(pool[subgroupIndex() * kSumTexels + at])); \
  }                                                                                      \
  SUBGROUP_BARRIER

// First row and column of fragments of a subgroup.
uint firstRow(uint subgroup) { return subgroup % kRowGroups * kFragmentRows; }
uint firstColumn(uint subgroup) { return subgroup / kRowGroups * kFragmentColumns; }

#endif
