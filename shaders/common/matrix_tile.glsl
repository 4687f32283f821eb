// How a workgroup of the matrix kernels of `linear` and `conv3x3` shares 16 kMatrixRows tokens by 16 kOutputFragments outputs
// among its subgroups. The kernel defines LEFT_TEXELS and RIGHT_TEXELS.
#ifndef XRDS_SHADERS_COMMON_MATRIX_TILE_GLSL
#define XRDS_SHADERS_COMMON_MATRIX_TILE_GLSL
#include "shaders/common/matrix.glsl"

layout(constant_id = 1) const uint kOutputFragments = 4;  // the workgroup's outputs, in sixteens
layout(constant_id = 2) const uint kFragmentRows = 2;     // of a subgroup, of the kMatrixRows of the workgroup
layout(constant_id = 3) const uint kFragmentColumns = 2;  // of a subgroup
const uint kRowGroups = kMatrixRows / kFragmentRows;
shared uvec4 left[LEFT_TEXELS], right[RIGHT_TEXELS];
shared uvec4 stored[kSubgroups * 64];  // a sum of each subgroup, in rows of four texels

// Four outputs of a row of the stored sums: quad i % 4 of row i % 64 / 4 of subgroup i / 64.
vec4 storedQuad(uint i) { return uintBitsToFloat(stored[i]); }

// First row and column of fragments of a subgroup.
uint firstRow(uint subgroup) { return subgroup % kRowGroups * kFragmentRows; }
uint firstColumn(uint subgroup) { return subgroup / kRowGroups * kFragmentColumns; }

#endif
