// Products of 16 x 16 matrices of halves, added up in fp32, a subgroup each. `memory` is an array of texels, in shared memory or a
// buffer; a texel is eight halves of a row (of stored sums four floats), and a matrix's rows lie `rowTexels` apart. Of the right
// operand it is eight halves of a column, and `columnTexels` lie between columns: so an invocation reads whole texels of either.
// XRDS_MATRIX_NV, XRDS_MATRIX_KHR: by the matrix units, through that extension, in products of their size. XRDS_MATRIX_SOFTWARE: by plain arithmetic,
// 32 invocations in the place of a subgroup, so that kernels are tested on devices without such units.
// A workgroup has kInvocations. The kernel requires GL_EXT_control_flow_attributes.
#ifndef XRDS_SHADERS_COMMON_MATRIX_GLSL
#define XRDS_SHADERS_COMMON_MATRIX_GLSL
#include "shaders/common/half.glsl"
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
layout(constant_id = 0) const uint kSubgroups = 8;  // of the workgroup
const uint kInvocations = gl_WorkGroupSize.x;

#ifdef XRDS_MATRIX_SOFTWARE
#define LEFT_FRAGMENT(name) uvec4 name[2]       // a row, for two invocations
#define RIGHT_FRAGMENT(name) float name[16][8]  // eight columns
#define SUM(name) float name[8]                 // half a row
#define LEFT_FRAGMENTS(name, count) uvec4 name[count][2]
#define SUMS(name, rows, columns) float name[rows][columns][8]
#define LOAD_LEFT(fragment, memory, texel, rowTexels) \
  for (uint h_ = 0; h_ < 2; h_++) fragment[h_] = memory[(texel) + lane() / 2 * (rowTexels) + h_]
#define LOAD_RIGHT(fragment, memory, texel, columnTexels)                                              \
  for (uint k_ = 0; k_ < 16; k_++)                                                                     \
    for (uint n_ = 0; n_ < 8; n_++)                                                                    \
      fragment[k_][n_] = halvesOf(memory[(texel) + (lane() % 2 * 8 + n_) * (columnTexels) + k_ / 8])[k_ % 8]
#define FILL_LEFT(fragment, number) fragment = uvec4[](uvec4(packHalf2x16(vec2(number))), uvec4(packHalf2x16(vec2(number))))
#define CLEAR_SUM(sum) sum = float[](0, 0, 0, 0, 0, 0, 0, 0)
#define COPY_SUM(sum, other) sum = other
#define APPLY(function, sum) \
  for (uint n_ = 0; n_ < 8; n_++) sum[n_] = function(sum[n_])
#define MULTIPLY_ADD(a, b, sum) addProduct(a, b, sum)
#define STORE_SUM(sum, memory, texel, rowTexels) \
  for (uint h_ = 0; h_ < 2; h_++)                \
    memory[(texel) + lane() / 2 * (rowTexels) + lane() % 2 * 2 + h_] = floatBitsToUint(quadOf(sum, h_))
#define STORE_HALVES(sum, memory, texel, rowTexels) \
  memory[(texel) + lane() / 2 * (rowTexels) + lane() % 2] = roundedHalves(quadOf(sum, 0), quadOf(sum, 1))
// Neighbours share a word.
#define STORE_HALVES_TRANSPOSED(sum, memory, texel, columnTexels)                                                   \
  for (uint n_ = 0; n_ < 8; n_++) {                                                                                 \
    const uint at_ = (texel) + (lane() % 2 * 8 + n_) * (columnTexels) + lane() / 16, shift_ = lane() / 2 % 2 * 16;  \
    const uint bits_ = (packHalf4(vec4(sum[n_])).x & 0xFFFFu) << shift_;                                            \
    SET_HALF(memory[at_], lane() / 4 % 4, ~(0xFFFFu << shift_), bits_)                                              \
  }
#define SET_HALF(to, word, kept, bits)                                              \
  if (word == 0) { atomicAnd(to.x, kept); atomicOr(to.x, bits); }                   \
  if (word == 1) { atomicAnd(to.y, kept); atomicOr(to.y, bits); }                   \
  if (word == 2) { atomicAnd(to.z, kept); atomicOr(to.z, bits); }                   \
  if (word == 3) { atomicAnd(to.w, kept); atomicOr(to.w, bits); }
#define SUBGROUP_BARRIER barrier()
uint subgroupIndex() { return gl_LocalInvocationIndex / 32; }
uint lane() { return gl_LocalInvocationIndex % 32; }

float[8] halvesOf(uvec4 texel) {
  const vec2 a = unpackHalf2x16(texel.x), b = unpackHalf2x16(texel.y), c = unpackHalf2x16(texel.z),
             d = unpackHalf2x16(texel.w);
  return float[](a.x, a.y, b.x, b.y, c.x, c.y, d.x, d.y);
}

vec4 quadOf(float sum[8], uint h) { return vec4(sum[4 * h], sum[4 * h + 1], sum[4 * h + 2], sum[4 * h + 3]); }

void addProduct(uvec4 a[2], float b[16][8], inout float sum[8]) {
  for (uint h = 0; h < 2; h++) {
    const float row[8] = halvesOf(a[h]);
    for (uint k = 0; k < 8; k++)
      for (uint n = 0; n < 8; n++) sum[n] += row[k] * b[8 * h + k][n];
  }
}
#endif

#ifdef XRDS_MATRIX_NV
#define UNIT_LEFT fcoopmatNV<16, gl_ScopeSubgroup, kUnitRows, kUnitDepth>
#define UNIT_RIGHT fcoopmatNV<16, gl_ScopeSubgroup, kUnitDepth, kUnitColumns>
#define UNIT_SUM fcoopmatNV<32, gl_ScopeSubgroup, kUnitRows, kUnitColumns>
#define UNIT_HALF_SUM fcoopmatNV<16, gl_ScopeSubgroup, kUnitRows, kUnitColumns>
#define UNIT_LOAD(m, memory, texel, rowTexels) coopMatLoadNV(m, memory, texel, rowTexels, false)
#define UNIT_LOAD_TRANSPOSED(m, memory, texel, rowTexels) coopMatLoadNV(m, memory, texel, rowTexels, true)
#define UNIT_STORE(m, memory, texel, rowTexels) coopMatStoreNV(m, memory, texel, rowTexels, false)
#define UNIT_STORE_TRANSPOSED(m, memory, texel, rowTexels) coopMatStoreNV(m, memory, texel, rowTexels, true)
#define UNIT_MULTIPLY_ADD coopMatMulAddNV
#endif
#ifdef XRDS_MATRIX_KHR
#define UNIT_LEFT coopmat<float16_t, gl_ScopeSubgroup, kUnitRows, kUnitDepth, gl_MatrixUseA>
#define UNIT_RIGHT coopmat<float16_t, gl_ScopeSubgroup, kUnitDepth, kUnitColumns, gl_MatrixUseB>
#define UNIT_SUM coopmat<float, gl_ScopeSubgroup, kUnitRows, kUnitColumns, gl_MatrixUseAccumulator>
#define UNIT_HALF_SUM coopmat<float16_t, gl_ScopeSubgroup, kUnitRows, kUnitColumns, gl_MatrixUseAccumulator>
#define UNIT_LOAD(m, memory, texel, rowTexels) coopMatLoad(m, memory, texel, rowTexels, gl_CooperativeMatrixLayoutRowMajor)
#define UNIT_LOAD_TRANSPOSED(m, memory, texel, rowTexels) \
  coopMatLoad(m, memory, texel, rowTexels, gl_CooperativeMatrixLayoutColumnMajor)
#define UNIT_STORE(m, memory, texel, rowTexels) coopMatStore(m, memory, texel, rowTexels, gl_CooperativeMatrixLayoutRowMajor)
#define UNIT_STORE_TRANSPOSED(m, memory, texel, rowTexels) \
  coopMatStore(m, memory, texel, rowTexels, gl_CooperativeMatrixLayoutColumnMajor)
#define UNIT_MULTIPLY_ADD coopMatMulAdd
#endif

#ifndef XRDS_MATRIX_SOFTWARE
layout(constant_id = 6) const uint kUnitRows = 16;  // of the products that the units take, 8 or 16 each
layout(constant_id = 7) const uint kUnitColumns = 16;
layout(constant_id = 8) const uint kUnitDepth = 16;
const uint kDown = 16 / kUnitRows, kAcross = 16 / kUnitColumns, kDeep = 16 / kUnitDepth;
// A fragment of 16 x 16 has one to four pieces. Macros: drivers do badly with such matrices in structures and functions.
#define LEFT_FRAGMENT(name) UNIT_LEFT name[4]
#define RIGHT_FRAGMENT(name) UNIT_RIGHT name[4]
#define SUM(name) UNIT_SUM name[4]
#define LEFT_FRAGMENTS(name, count) UNIT_LEFT name[count][4]
#define SUMS(name, rows, columns) UNIT_SUM name[rows][columns][4]
#define EACH_PIECE(i_, j_)                         \
  [[unroll]] for (uint i_ = 0; i_ < kDown; i_++) \
    [[unroll]] for (uint j_ = 0; j_ < kAcross; j_++)
#define LOAD_LEFT(fragment, memory, texel, rowTexels)                                                                     \
  [[unroll]] for (uint i_ = 0; i_ < kDown; i_++)                                                                          \
    [[unroll]] for (uint k_ = 0; k_ < kDeep; k_++)                                                                        \
      UNIT_LOAD(fragment[i_ * kDeep + k_], memory, (texel) + i_ * kUnitRows * (rowTexels) + k_ * kUnitDepth / 8, rowTexels)
#define LOAD_RIGHT(fragment, memory, texel, columnTexels)                                                                 \
  [[unroll]] for (uint k_ = 0; k_ < kDeep; k_++)                                                                          \
    [[unroll]] for (uint j_ = 0; j_ < kAcross; j_++)                                                                      \
      UNIT_LOAD_TRANSPOSED(fragment[k_ * kAcross + j_], memory,                                                           \
                           (texel) + j_ * kUnitColumns * (columnTexels) + k_ * kUnitDepth / 8, columnTexels)
#define FILL_LEFT(fragment, number)                                                                                       \
  [[unroll]] for (uint i_ = 0; i_ < kDown * kDeep; i_++) fragment[i_] = UNIT_LEFT(number)
#define CLEAR_SUM(sum) EACH_PIECE(i_, j_) sum[i_ * kAcross + j_] = UNIT_SUM(0.0)
#define COPY_SUM(sum, other) EACH_PIECE(i_, j_) sum[i_ * kAcross + j_] = other[i_ * kAcross + j_]
#define APPLY(function, sum)                                                                                              \
  EACH_PIECE(i_, j_)                                                                                                      \
    [[unroll]] for (uint n_ = 0; n_ < sum[i_ * kAcross + j_].length(); n_++)                                              \
      sum[i_ * kAcross + j_][n_] = function(sum[i_ * kAcross + j_][n_])
#define MULTIPLY_ADD(a, b, sum)                                                                                           \
  EACH_PIECE(i_, j_)                                                                                                      \
    [[unroll]] for (uint k_ = 0; k_ < kDeep; k_++)                                                                        \
      sum[i_ * kAcross + j_] = UNIT_MULTIPLY_ADD(a[i_ * kDeep + k_], b[k_ * kAcross + j_], sum[i_ * kAcross + j_])
#define STORE_SUM(sum, memory, texel, rowTexels)                                                                          \
  EACH_PIECE(i_, j_)                                                                                                      \
    UNIT_STORE(sum[i_ * kAcross + j_], memory, (texel) + i_ * kUnitRows * (rowTexels) + j_ * kUnitColumns / 4, rowTexels)
#define STORE_HALVES(sum, memory, texel, rowTexels)                                                                       \
  EACH_PIECE(i_, j_) {                                                                                                    \
    UNIT_HALF_SUM half_ = UNIT_HALF_SUM(sum[i_ * kAcross + j_]);                                                          \
    UNIT_STORE(half_, memory, (texel) + i_ * kUnitRows * (rowTexels) + j_ * kUnitColumns / 8, rowTexels);                 \
  }
#define STORE_HALVES_TRANSPOSED(sum, memory, texel, columnTexels)                                                         \
  EACH_PIECE(i_, j_) {                                                                                                    \
    UNIT_HALF_SUM half_ = UNIT_HALF_SUM(sum[i_ * kAcross + j_]);                                                          \
    UNIT_STORE_TRANSPOSED(half_, memory, (texel) + j_ * kUnitColumns * (columnTexels) + i_ * kUnitRows / 8, columnTexels); \
  }
// What the subgroup has stored in shared memory, all of it sees.
#define SUBGROUP_BARRIER subgroupBarrier()
uint subgroupIndex() { return gl_SubgroupID; }
uint lane() { return gl_SubgroupInvocationID; }
#endif
const uint kLanes = kInvocations / kSubgroups;

// The texel of eight channels that were read as floats; of halves, nothing is lost.
uvec4 halves(vec4 a, vec4 b) {
  return uvec4(packHalf2x16(a.xy), packHalf2x16(a.zw), packHalf2x16(b.xy), packHalf2x16(b.zw));
}

// Of any floats.
uvec4 roundedHalves(vec4 a, vec4 b) { return uvec4(packHalf4(a), packHalf4(b)); }

#endif
