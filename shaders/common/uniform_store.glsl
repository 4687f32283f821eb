// Stores of lane kernels, lane after lane, at addresses that a CPU driver sees to be uniform. lavapipe makes of any other
// store a loop over the lanes that spills the stored vectors in every round (two thirds of the time of a linear layer of
// 64 channels); a store at a uniform address, outside of control flow, is one move of the first lane's value. It takes for
// uniform: constants, push constants at any index, and what is computed of these. So a number becomes uniform when its
// digits are looked up in the push constants. Where kKnowsUniforms, a broadcast does instead. Included after local_size;
// the kernel defines PARAMS and TARGET_BINDING, and SMALL_DIGITS if its parameters leave room for a table of 4 digits
// only instead of 16.
#ifndef XRDS_SHADERS_COMMON_UNIFORM_STORE_GLSL
#define XRDS_SHADERS_COMMON_UNIFORM_STORE_GLSL
#extension GL_EXT_shader_subgroup_extended_types_int64 : require
#extension GL_KHR_memory_scope_semantics : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "shaders/common/wide_storage.glsl"
layout(binding = TARGET_BINDING, std430) writeonly buffer Target { WIDE4 target[]; };
layout(binding = TARGET_BINDING, std430) writeonly buffer TargetOfEights { WIDE8 target8[]; };  // the same
const uint kLanes = gl_WorkGroupSize.x;  // the subgroup size
#ifdef SMALL_DIGITS
const uint kDigitBits = 2;
#else
const uint kDigitBits = 4;
#endif
layout(push_constant) uniform Push { PARAMS p; uint digit[1 << kDigitBits]; };  // digit[i] = i
layout(constant_id = 32) const uint kLaneCode = 0;  // engine/dispatch.h: kLaneCodeConstant and LaneCode
#ifdef XRDS_ADDRESSED
const bool kBroadcasts = true, kKnowsUniforms = true;  // the digits are not all there
#else
const bool kBroadcasts = kLaneCode >= 1, kKnowsUniforms = kLaneCode == 2;
#endif

// The value of the lane, in all lanes. The lane is constant.
#define HAND_OUT(type)                                   \
  type handedOut(type value, const uint lane) {          \
    if (kBroadcasts)                                     \
      return subgroupBroadcast(value, lane);             \
    else                                                 \
      return subgroupShuffle(value, lane);               \
  }
HAND_OUT(float)
HAND_OUT(vec4)
HAND_OUT(WIDE4)
HAND_OUT(WIDE8)

// The value itself. A compiler that needs one behind a barrier prefers to compute it again there; it keeps what is
// shuffled.
vec4 kept(vec4 v) { return subgroupShuffle(v, gl_SubgroupInvocationID); }
uint kept(uint v) { return subgroupShuffle(v, gl_SubgroupInvocationID); }

// All subgroups of the workgroup come to here before one goes on: what is written out between two such places stays in
// the instruction cache. With barrier(), which orders memory, Mesa from 25.0 on waits here until all stores are done; to
// Mesa 22.3 that costs nothing, and without it its convolutions take twice the time.
void waitForTurn() {
  if (kBroadcasts)
    controlBarrier(gl_ScopeWorkgroup, gl_ScopeWorkgroup, 0, 0);
  else
    barrier();
}

// sum + x * w. Where kKnowsUniforms, fma() is one instruction; of the other drivers it only makes compiling slower.
#define PLUS_PRODUCT(type)                                 \
  type plusProduct(type sum, float x, type w) {            \
    if (kKnowsUniforms)                                    \
      return fma(type(x), w, sum);                         \
    else                                                   \
      return sum + x * w;                                  \
  }
PLUS_PRODUCT(float)
PLUS_PRODUCT(vec4)

// The value, which is the same in all lanes of the subgroup and below 16^digits.
uint uniformOf(uint value, const uint digits) {
  if (kKnowsUniforms) return subgroupBroadcastFirst(value);
  const uint mask = (1 << kDigitBits) - 1;
  uint sum = 0;
  [[unroll]] for (uint i = 0; i < 4 * digits; i += kDigitBits) sum += digit[value >> i & mask] << i;
  return sum;
}

// Copies texels `first` and on of `weights` to the shared array `tile` of `count` vec4, all subgroups taking their part.
#define STAGE_WEIGHTS(tile, weights, first, count)                                                                      \
  [[unroll]] for (uint chunk = 0; chunk < (count + kLanes * gl_WorkGroupSize.y - 1) / (kLanes * gl_WorkGroupSize.y);    \
                  chunk++) {                                                                                            \
    const uint begin = (chunk * gl_WorkGroupSize.y + uniformOf(gl_LocalInvocationID.y, 2)) * kLanes;                    \
    const uint own = min(begin + gl_LocalInvocationID.x, count - 1);                                                    \
    const vec4 fetched = texelFetch(weights, int(first + own));                                                         \
    if (kBroadcasts)                                                                                                    \
      tile[own] = fetched;                                                                                              \
    else                                                                                                                \
      [[unroll]] for (uint l = 0; l < kLanes; l++) tile[min(begin + l, count - 1)] = handedOut(fetched, l);             \
  }                                                                                                                     \
  barrier()

// Four channels of one lane, at a vec4 index of the target. Index and lane are uniform. One store, which drivers are
// faster to prepare than two of half of them.
void storeLane(uint at, WIDE4 channels, const uint lane) { target[at] = handedOut(channels, lane); }

// Eight channels, at an index of eights.
void storeLane8(uint at, WIDE8 channels, const uint lane) { target8[at] = handedOut(channels, lane); }

#endif
