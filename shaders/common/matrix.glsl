// Products of 16 x 16 matrices of halves that lie in shared memory, added up in fp32, a subgroup each.
// XRDS_MATRIX_NV, XRDS_MATRIX_KHR: by the matrix units, through that extension, in products of their size. XRDS_MATRIX_SOFTWARE: by plain arithmetic,
// 32 invocations in the place of a subgroup, so that kernels are tested on devices without such units.
// The kernel defines LEFT_TEXELS and RIGHT_TEXELS; a texel is eight halves of a row. A workgroup has kInvocations.
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

layout(local_size_x_id = 9) in;
layout(constant_id = 0) const uint kSubgroups = 8;        // of the workgroup
layout(constant_id = 1) const uint kOutputFragments = 4;  // the workgroup's outputs, in sixteens
layout(constant_id = 2) const uint kFragmentRows = 2;     // of a subgroup, of the kMatrixRows of the workgroup
layout(constant_id = 3) const uint kFragmentColumns = 2;  // of a subgroup
const uint kInvocations = gl_WorkGroupSize.x;
const uint kRowGroups = kMatrixRows / kFragmentRows;
shared uvec4 left[LEFT_TEXELS], right[RIGHT_TEXELS];
shared float stored[kSubgroups * 256];  // a sum of each subgroup

#ifdef XRDS_MATRIX_SOFTWARE
#define LEFT_FRAGMENTS(name, count) uvec2 name[count]
#define RIGHT_FRAGMENT(name) uvec2 name
#define SUMS(name, rows, columns) float name[rows][columns][8]  // half a row
#define LOAD_LEFT(fragment, texel, rowTexels) fragment = uvec2(texel, rowTexels)
#define LOAD_RIGHT(fragment, texel, rowTexels) fragment = uvec2(texel, rowTexels)
#define CLEAR_SUM(sum) sum = float[](0, 0, 0, 0, 0, 0, 0, 0)
#define MULTIPLY_ADD(a, b, sum) addProduct(a, b, sum)
#define STORE_SUM(sum) \
  for (uint n = 0; n < 8; n++) stored[subgroupIndex() * 256 + lane() * 8 + n] = sum[n]
uint subgroupIndex() { return gl_LocalInvocationIndex / 32; }
uint lane() { return gl_LocalInvocationIndex % 32; }

float[8] halvesOf(uvec4 texel) {
  const vec2 a = unpackHalf2x16(texel.x), b = unpackHalf2x16(texel.y), c = unpackHalf2x16(texel.z),
             d = unpackHalf2x16(texel.w);
  return float[](a.x, a.y, b.x, b.y, c.x, c.y, d.x, d.y);
}

void addProduct(uvec2 a, uvec2 b, inout float sum[8]) {
  for (uint half_ = 0; half_ < 2; half_++) {
    const float row[8] = halvesOf(left[a.x + lane() / 2 * a.y + half_]);
    for (uint k = 0; k < 8; k++) {
      const float column[8] = halvesOf(right[b.x + (8 * half_ + k) * b.y + lane() % 2]);
      for (uint n = 0; n < 8; n++) sum[n] += row[k] * column[n];
    }
  }
}
#endif

#ifdef XRDS_MATRIX_NV
#define UNIT_LEFT fcoopmatNV<16, gl_ScopeSubgroup, kUnitRows, kUnitDepth>
#define UNIT_RIGHT fcoopmatNV<16, gl_ScopeSubgroup, kUnitDepth, kUnitColumns>
#define UNIT_SUM fcoopmatNV<32, gl_ScopeSubgroup, kUnitRows, kUnitColumns>
#define UNIT_LOAD(m, from, texel, rowTexels) coopMatLoadNV(m, from, texel, rowTexels, false)
#define UNIT_STORE(m, at) coopMatStoreNV(m, stored, at, 16, false)
#define UNIT_MULTIPLY_ADD coopMatMulAddNV
#endif
#ifdef XRDS_MATRIX_KHR
#define UNIT_LEFT coopmat<float16_t, gl_ScopeSubgroup, kUnitRows, kUnitDepth, gl_MatrixUseA>
#define UNIT_RIGHT coopmat<float16_t, gl_ScopeSubgroup, kUnitDepth, kUnitColumns, gl_MatrixUseB>
#define UNIT_SUM coopmat<float, gl_ScopeSubgroup, kUnitRows, kUnitColumns, gl_MatrixUseAccumulator>
#define UNIT_LOAD(m, from, texel, rowTexels) coopMatLoad(m, from, texel, rowTexels, gl_CooperativeMatrixLayoutRowMajor)
#define UNIT_STORE(m, at) coopMatStore(m, stored, at, 16, gl_CooperativeMatrixLayoutRowMajor)
#define UNIT_MULTIPLY_ADD coopMatMulAdd
#endif

#ifndef XRDS_MATRIX_SOFTWARE
layout(constant_id = 6) const uint kUnitRows = 16;  // of the products that the units take, 8 or 16 each
layout(constant_id = 7) const uint kUnitColumns = 16;
layout(constant_id = 8) const uint kUnitDepth = 16;
const uint kDown = 16 / kUnitRows, kAcross = 16 / kUnitColumns, kDeep = 16 / kUnitDepth;
// A fragment of 16 x 16 has one to four pieces. Macros: drivers do badly with such matrices in structures and functions.
#define LEFT_FRAGMENTS(name, count) UNIT_LEFT name[count][4]
#define RIGHT_FRAGMENT(name) UNIT_RIGHT name[4]
#define SUMS(name, rows, columns) UNIT_SUM name[rows][columns][4]
#define LOAD_LEFT(fragment, texel, rowTexels)                                                                             \
  [[unroll]] for (uint i = 0; i < kDown; i++)                                                                             \
    [[unroll]] for (uint k_ = 0; k_ < kDeep; k_++)                                                                        \
      UNIT_LOAD(fragment[i * kDeep + k_], left, (texel) + i * kUnitRows * (rowTexels) + k_ * kUnitDepth / 8, (rowTexels))
#define LOAD_RIGHT(fragment, texel, rowTexels)                                                                            \
  [[unroll]] for (uint k_ = 0; k_ < kDeep; k_++)                                                                          \
    [[unroll]] for (uint j = 0; j < kAcross; j++)                                                                         \
      UNIT_LOAD(fragment[k_ * kAcross + j], right, (texel) + k_ * kUnitDepth * (rowTexels) + j * kUnitColumns / 8, (rowTexels))
#define CLEAR_SUM(sum) \
  [[unroll]] for (uint i = 0; i < kDown * kAcross; i++) sum[i] = UNIT_SUM(0.0)
#define MULTIPLY_ADD(a, b, sum)                                                                                           \
  [[unroll]] for (uint i = 0; i < kDown; i++)                                                                             \
    [[unroll]] for (uint j = 0; j < kAcross; j++)                                                                         \
      [[unroll]] for (uint k_ = 0; k_ < kDeep; k_++)                                                                      \
        sum[i * kAcross + j] = UNIT_MULTIPLY_ADD(a[i * kDeep + k_], b[k_ * kAcross + j], sum[i * kAcross + j])
#define STORE_SUM(sum)                                                                                                    \
  [[unroll]] for (uint i = 0; i < kDown; i++)                                                                             \
    [[unroll]] for (uint j = 0; j < kAcross; j++)                                                                         \
      UNIT_STORE(sum[i * kAcross + j], subgroupIndex() * 256 + i * kUnitRows * 16 + j * kUnitColumns)
uint subgroupIndex() { return gl_SubgroupID; }
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
