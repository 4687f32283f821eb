// y = softmax(q k^T / sqrt(d) + bias) v as in window_attention.comp, for CPU devices.
// A subgroup takes kQueries * kLanes queries of one window and head, kQueries consecutive ones a lane, and walks over the
// keys kKeys at a time: lanes hold keys and values, which a shuffle with a constant lane hands to all of them, and the
// softmax keeps a running maximum. Powers of 2: log2(e) is in the bias and the query scale. fp32.
// bias: [class of the window: + 1 in the last column, + 2 in the last row][head][key / kKeys][query][kKeys], hidden keys
// -1e30, queries padded to whole subgroups.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "shaders/window_attention/window_attention.h"
layout(local_size_x_id = 0, local_size_y = 4) in;  // x = subgroup size
layout(constant_id = 1) const uint kWindow = 8;
layout(constant_id = 2) const uint kHeadChannels = 32;
layout(constant_id = 3) const uint kQueries = 8;
layout(constant_id = 4) const uint kKeys = 4;
layout(constant_id = 5) const bool kPaired = true;  // keys in the lower half of the lanes, values of the same tensor above
const uint kLanes = gl_WorkGroupSize.x;
const uint kTokens = kWindow * kWindow;
const uint kQuads = kHeadChannels / 4;
const uint kKeySteps = (kTokens + kKeys - 1) / kKeys;
const uint kBlocks = (kTokens + kLanes * kQueries - 1) / (kLanes * kQueries);  // subgroups a window and head
layout(binding = 0) uniform samplerBuffer queries;
layout(binding = 1) uniform samplerBuffer keys;
layout(binding = 2) uniform samplerBuffer values;
layout(binding = 3) uniform samplerBuffer bias;
layout(push_constant) uniform Push { WindowAttentionParams p; };

#ifdef XRDS_F16
#define WIDE4 uint64_t
WIDE4 wide4(vec4 v) { return packUint2x32(uvec2(packHalf2x16(v.xy), packHalf2x16(v.zw))); }
#else
#define WIDE4 u64vec2
WIDE4 wide4(vec4 v) { return u64vec2(packUint2x32(floatBitsToUint(v.xy)), packUint2x32(floatBitsToUint(v.zw))); }
#endif
layout(binding = 4, std430) writeonly buffer Target { WIDE4 target[]; };

// Pixel of a token of the window whose first token lies at `corner` of the shifted image.
uvec2 pixelOf(uvec2 corner, uint token) {
  const uvec2 size = uvec2(p.width, p.height);
  const uvec2 pixel = corner + uvec2(token % kWindow, token / kWindow) + p.shift;
  return pixel - mix(uvec2(0), size, greaterThanEqual(pixel, size));
}

uint texelOf(Slice slice, uvec2 pixel, uint head) {
  return (pixel.y * p.width + pixel.x) * slice.stride + slice.offset + head * kQuads;
}

// 2^x for x <= 0, relative error 2e-7.
float power2(float x) {
  x = max(x, -126.0);
  const float whole = roundEven(x), f = x - whole;
  const float fraction =
      1.0 + f * (0.69314718 + f * (0.24022651 + f * (0.055503324 + f * (0.0096184374 + f * 0.0013398874))));
  return intBitsToFloat(floatBitsToInt(fraction) + (int(whole) << 23));
}

void main() {
  const uint lane = gl_LocalInvocationID.x;
  const uint unitsInRow = p.width / kWindow * p.headCount * kBlocks;
  const uint unit = min(gl_WorkGroupID.x * gl_WorkGroupSize.y + gl_LocalInvocationID.y, unitsInRow - 1);
  const uint block = unit % kBlocks;
  const uint head = unit / kBlocks % p.headCount;
  const uint windowRows = p.height / kWindow;
  const uint windowRow = (p.firstWindowRow + gl_WorkGroupID.y) % windowRows;
  const uvec2 window = uvec2(unit / kBlocks / p.headCount, windowRow);
  const uvec2 corner = kWindow * window;
  const uvec2 last = uvec2(equal(window, uvec2(p.width / kWindow, windowRows) - 1));
  const uint windowClass = p.shift == 0 ? 0 : last.x + 2 * last.y;
  const uint firstQuery = (block * kLanes + lane) * kQueries;

  vec4 q[kQueries][kQuads], result[kQueries][kQuads];
  float highest[kQueries], sum[kQueries];
  [[unroll]] for (uint i = 0; i < kQueries; i++) {
    const uint from = texelOf(p.queries, pixelOf(corner, min(firstQuery + i, kTokens - 1)), head);
    [[unroll]] for (uint c = 0; c < kQuads; c++) {
      q[i][c] = texelFetch(queries, int(from + c)) * (1.44269504 * inversesqrt(float(kHeadChannels)));
      result[i][c] = vec4(0);
    }
    highest[i] = -1e30;
    sum[i] = 0;
  }

  uint biasFrom = ((windowClass * p.headCount + head) * kKeySteps * kBlocks * kLanes * kQueries + firstQuery) * (kKeys / 4);
  for (uint step = 0; step < kKeySteps; step++) {
    const uvec2 keyPixel = pixelOf(corner, min(step * kKeys + lane % kKeys, kTokens - 1));
    const uint keyFrom = texelOf(p.keys, keyPixel, head), valueFrom = texelOf(p.values, keyPixel, head);
    vec4 k[kQuads], v[kQuads];
    if (kPaired) {
      const uint from = lane < kKeys ? keyFrom : valueFrom;
      [[unroll]] for (uint c = 0; c < kQuads; c++) k[c] = v[c] = texelFetch(keys, int(from + c));
    } else {
      [[unroll]] for (uint c = 0; c < kQuads; c++) {
        k[c] = texelFetch(keys, int(keyFrom + c));
        v[c] = texelFetch(values, int(valueFrom + c));
      }
    }

    float weight[kQueries][kKeys];
    [[unroll]] for (uint i = 0; i < kQueries; i++)
      [[unroll]] for (uint j = 0; j < kKeys; j += 4) {
        const vec4 start = texelFetch(bias, int(biasFrom + (i * kKeys + j) / 4));
        [[unroll]] for (uint n = 0; n < 4; n++) weight[i][j + n] = start[n];
      }
    biasFrom += kBlocks * kLanes * kQueries * (kKeys / 4);
    [[unroll]] for (uint j = 0; j < kKeys; j++)
      [[unroll]] for (uint c = 0; c < kHeadChannels; c++) {
        const float key = subgroupShuffle(k[c / 4][c % 4], j);
        [[unroll]] for (uint i = 0; i < kQueries; i++) weight[i][j] += q[i][c / 4][c % 4] * key;
      }

    float kept[kQueries];
    [[unroll]] for (uint i = 0; i < kQueries; i++) {
      float top = highest[i];
      [[unroll]] for (uint j = 0; j < kKeys; j++) top = max(top, weight[i][j]);
      kept[i] = power2(highest[i] - top);
      highest[i] = top;
      sum[i] *= kept[i];
      [[unroll]] for (uint j = 0; j < kKeys; j++) {
        weight[i][j] = power2(weight[i][j] - top);
        sum[i] += weight[i][j];
      }
    }
    [[unroll]] for (uint c = 0; c < kHeadChannels; c++) {
      [[unroll]] for (uint i = 0; i < kQueries; i++) result[i][c / 4][c % 4] *= kept[i];
      [[unroll]] for (uint j = 0; j < kKeys; j++) {
        const float value = subgroupShuffle(v[c / 4][c % 4], (kPaired ? kKeys : 0) + j);
        [[unroll]] for (uint i = 0; i < kQueries; i++) result[i][c / 4][c % 4] += weight[i][j] * value;
      }
    }
  }

  [[unroll]] for (uint i = 0; i < kQueries; i++) {
    const uvec2 pixel = pixelOf(corner, min(firstQuery + i, kTokens - 1));
    const uint to = texelOf(p.target, pixel, head) - p.storeOrigin;
    const float scale = 1.0 / sum[i];
    if (pixel.y >= p.rowBegin && pixel.y < p.rowEnd)
      [[unroll]] for (uint c = 0; c < kQuads; c++) target[to + c] = wide4(result[i][c] * scale);
  }
}
