// Products of 16 x 16 matrices of halves that lie in shared memory, added up in fp32, a subgroup each.
// XRDS_MATRIX_NV, XRDS_MATRIX_KHR: by the matrix units, through that extension. XRDS_MATRIX_SOFTWARE: by plain arithmetic,
// 32 invocations in the place of a subgroup, so that kernels are tested on devices without such units.
// The kernel defines LEFT_TEXELS and RIGHT_TEXELS; a texel is eight halves of a row. A workgroup has kMatrixInvocations.
#ifndef XRDS_SHADERS_COMMON_MATRIX_GLSL
#define XRDS_SHADERS_COMMON_MATRIX_GLSL
#include "shaders/common/matrix.h"
#ifdef XRDS_MATRIX_SOFTWARE
#else
#extension GL_KHR_memory_scope_semantics : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require
#pragma use_vulkan_memory_model
#endif
#ifdef XRDS_MATRIX_NV
#extension GL_NV_cooperative_matrix : require
#endif
#ifdef XRDS_MATRIX_KHR
#extension GL_KHR_cooperative_matrix : require
#endif

layout(local_size_x = kMatrixInvocations) in;
layout(constant_id = 0) const uint kSubgroups = 8;        // of the workgroup
layout(constant_id = 1) const uint kOutputFragments = 4;  // the workgroup's outputs, in sixteens
layout(constant_id = 2) const uint kFragmentRows = 2;     // of a subgroup, of the kMatrixRows of the workgroup
layout(constant_id = 3) const uint kFragmentColumns = 2;  // of a subgroup
const uint kRowGroups = kMatrixRows / kFragmentRows;
shared uvec4 left[LEFT_TEXELS], right[RIGHT_TEXELS];
shared float stored[kSubgroups * 256];  // a sum of each subgroup

#ifdef XRDS_MATRIX_SOFTWARE
#define Left uvec2
#define Right uvec2
struct Sum {
  float at[8];  // half a row
};
uint subgroupIndex() { return gl_LocalInvocationIndex / 32; }
uint lane() { return gl_LocalInvocationIndex % 32; }

Left loadLeft(uint texel, uint rowTexels) { return uvec2(texel, rowTexels); }
Right loadRight(uint texel, uint rowTexels) { return uvec2(texel, rowTexels); }

float[8] halvesOf(uvec4 texel) {
  const vec2 a = unpackHalf2x16(texel.x), b = unpackHalf2x16(texel.y), c = unpackHalf2x16(texel.z),
             d = unpackHalf2x16(texel.w);
  return float[](a.x, a.y, b.x, b.y, c.x, c.y, d.x, d.y);
}

Sum zeroSum() { return Sum(float[](0, 0, 0, 0, 0, 0, 0, 0)); }

Sum multiplyAdd(Left a, Right b, Sum sum) {
  for (uint half_ = 0; half_ < 2; half_++) {
    const float row[8] = halvesOf(left[a.x + lane() / 2 * a.y + half_]);
    for (uint k = 0; k < 8; k++) {
      const float column[8] = halvesOf(right[b.x + (8 * half_ + k) * b.y + lane() % 2]);
      for (uint n = 0; n < 8; n++) sum.at[n] += row[k] * column[n];
    }
  }
  return sum;
}

void storeSum(Sum sum) {
  for (uint n = 0; n < 8; n++) stored[subgroupIndex() * 256 + lane() * 8 + n] = sum.at[n];
}
#endif

#ifdef XRDS_MATRIX_NV
#define Left fcoopmatNV<16, gl_ScopeSubgroup, 16, 16>
#define Right fcoopmatNV<16, gl_ScopeSubgroup, 16, 16>
#define Sum fcoopmatNV<32, gl_ScopeSubgroup, 16, 16>
#define multiplyAdd coopMatMulAddNV
uint subgroupIndex() { return gl_SubgroupID; }

Left loadLeft(uint texel, uint rowTexels) {
  Left m;
  coopMatLoadNV(m, left, texel, rowTexels, false);
  return m;
}

Right loadRight(uint texel, uint rowTexels) {
  Right m;
  coopMatLoadNV(m, right, texel, rowTexels, false);
  return m;
}

Sum zeroSum() { return Sum(0.0); }
void storeSum(Sum sum) { coopMatStoreNV(sum, stored, subgroupIndex() * 256, 16, false); }
#endif

#ifdef XRDS_MATRIX_KHR
#define Left coopmat<float16_t, gl_ScopeSubgroup, 16, 16, gl_MatrixUseA>
#define Right coopmat<float16_t, gl_ScopeSubgroup, 16, 16, gl_MatrixUseB>
#define Sum coopmat<float, gl_ScopeSubgroup, 16, 16, gl_MatrixUseAccumulator>
#define multiplyAdd coopMatMulAdd
uint subgroupIndex() { return gl_SubgroupID; }

Left loadLeft(uint texel, uint rowTexels) {
  Left m;
  coopMatLoad(m, left, texel, rowTexels, gl_CooperativeMatrixLayoutRowMajor);
  return m;
}

Right loadRight(uint texel, uint rowTexels) {
  Right m;
  coopMatLoad(m, right, texel, rowTexels, gl_CooperativeMatrixLayoutRowMajor);
  return m;
}

Sum zeroSum() { return Sum(0.0); }
void storeSum(Sum sum) {
  coopMatStore(sum, stored, subgroupIndex() * 256, 16, gl_CooperativeMatrixLayoutRowMajor);
}
#endif

// The texel of eight channels that were read as floats; of halves, nothing is lost.
uvec4 halves(vec4 a, vec4 b) {
  return uvec4(packHalf2x16(a.xy), packHalf2x16(a.zw), packHalf2x16(b.xy), packHalf2x16(b.zw));
}

// Four outputs of a row of the stored sums: quad i % 4 of row i % 64 / 4 of subgroup i / 64.
vec4 storedQuad(uint i) { return vec4(stored[4 * i], stored[4 * i + 1], stored[4 * i + 2], stored[4 * i + 3]); }

// First row and column of fragments of a subgroup.
uint firstRow(uint subgroup) { return subgroup % kRowGroups * kFragmentRows; }
uint firstColumn(uint subgroup) { return subgroup / kRowGroups * kFragmentColumns; }

#endif
