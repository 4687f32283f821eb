// y = softmax(q k^T / sqrt(d) + bias) v over the tokens of each window and head as in window_attention.comp, for GPUs.
// A workgroup computes a window of a head, an invocation one query. kKeys keys and values at a time lie in shared memory,
// with the head's biases; scores of eight keys are taken together, with a running maximum. Any subgroup size. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/storage.glsl"
#include "shaders/window_attention/window_attention.h"
layout(local_size_x_id = 0) in;  // the tokens of a window
layout(constant_id = 1) const uint kWindow = 8;
layout(constant_id = 2) const uint kHeadChannels = 32;
layout(constant_id = 3) const uint kKeys = 8;
layout(constant_id = 4) const bool kShifted = false;
layout(binding = 0) uniform samplerBuffer queries;
layout(binding = 1) uniform samplerBuffer keys;
layout(binding = 2) uniform samplerBuffer values;
layout(binding = 3) uniform samplerBuffer table;
layout(binding = 4, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { WindowAttentionParams p; };

const uint kTokens = gl_WorkGroupSize.x, kQuads = kHeadChannels / 4, kRelative = 2 * kWindow - 1;
const float kHidden = -2e30, kLowest = -1e30;  // what is hidden never is the highest
const float kLog2E = 1.4426950408889634;         // scores are powers of two
shared vec4 k[kKeys * kQuads], v[kKeys * kQuads];
shared uint regions[kKeys], behind[kKeys];  // of a key; by how much its bias lies before that of key 0
shared float biases[(kRelative * kRelative + 3) / 4 * 4];  // what lies behind begins at a whole vec4

uvec2 inWindow(uint token) { return uvec2(token % kWindow, token / kWindow); }

// A bias of the query for key 0, and by how much that of another key lies before it.
uint firstBias(uvec2 query) { return (query.y + kWindow - 1) * kRelative + query.x + kWindow - 1; }
uint biasesBehind(uvec2 key) { return key.y * kRelative + key.x; }

// Which of the bands that the shift keeps apart a position of the shifted image lies in, as one number.
uint regionOf(uvec2 position) {
  const uvec2 size = uvec2(p.width, p.height);
  const uvec2 band = uvec2(greaterThanEqual(position, size - kWindow)) + uvec2(greaterThanEqual(position, size - p.shift));
  return band.y * 3 + band.x;
}

uint pixelOf(uvec2 position) {
  const uvec2 unshifted = (position + p.shift) % uvec2(p.width, p.height);
  return unshifted.y * p.width + unshifted.x;
}

// First texel of the pixel's channels of this head.
int texelOf(Slice slice, uint pixel) { return int(pixel * slice.stride + slice.offset + gl_WorkGroupID.z * kQuads); }

void stageBiases() {
  for (uint i = gl_LocalInvocationIndex; i < kRelative * kRelative; i += kTokens) {
    const uint entry = i * p.headCount + gl_WorkGroupID.z;
    biases[i] = texelFetch(table, int(entry / 4))[entry % 4] * kLog2E;
  }
}

// Keys, values and regions from that key on; zero behind the last.
void stageKeys(uvec2 corner, uint first) {
  for (uint i = gl_LocalInvocationIndex; i < kKeys * kQuads; i += kTokens) {
    const uint key = first + i / kQuads, pixel = pixelOf(corner + inWindow(min(key, kTokens - 1)));
    const vec4 keyTexel = texelFetch(keys, texelOf(p.keys, pixel) + int(i % kQuads));
    const vec4 valueTexel = texelFetch(values, texelOf(p.values, pixel) + int(i % kQuads));
    k[i] = key < kTokens ? keyTexel : vec4(0);
    v[i] = key < kTokens ? valueTexel : vec4(0);
  }
  for (uint i = gl_LocalInvocationIndex; i < kKeys; i += kTokens) {
    const uvec2 key = inWindow(min(first + i, kTokens - 1));
    regions[i] = first + i >= kTokens ? ~0u : kShifted ? regionOf(corner + key) : 0;
    behind[i] = biasesBehind(key);
  }
}

void main() {
  const uint windowRow = (p.firstWindowRow + gl_WorkGroupID.y) % (p.height / kWindow);
  const uvec2 corner = kWindow * uvec2(gl_WorkGroupID.x, windowRow), query = inWindow(gl_LocalInvocationIndex);
  const uint region = kShifted ? regionOf(corner + query) : 0, pixel = pixelOf(corner + query);
  const bool kSeesAll = !kShifted && kTokens % kKeys == 0;

  vec4 q[kQuads], result[kQuads];
  const int from = texelOf(p.queries, pixel);
  [[unroll]] for (uint c = 0; c < kQuads; c++) {
    q[c] = texelFetch(queries, from + int(c)) * (inversesqrt(float(kHeadChannels)) * kLog2E);
    result[c] = vec4(0);
  }
  stageBiases();
  float highest = kLowest, sum = 0;
  for (uint first = 0; first < kTokens; first += kKeys) {
    if (first > 0) barrier();
    stageKeys(corner, first);
    barrier();
    for (uint block = 0; block < kKeys; block += kAttentionTileKeys) {
      float weight[kAttentionTileKeys], before = highest;
      [[unroll]] for (uint i = 0; i < kAttentionTileKeys; i++) {
        vec4 products = vec4(biases[firstBias(query) - behind[block + i]], 0, 0, 0);
        [[unroll]] for (uint c = 0; c < kQuads; c++) products += q[c] * k[(block + i) * kQuads + c];
        const float score = products.x + products.y + products.z + products.w;
        weight[i] = kSeesAll || regions[block + i] == region ? score : kHidden;
        highest = max(highest, weight[i]);
      }
      const float kept = exp2(before - highest);
      sum *= kept;
      [[unroll]] for (uint c = 0; c < kQuads; c++) result[c] *= kept;
      [[unroll]] for (uint i = 0; i < kAttentionTileKeys; i++) {
        weight[i] = exp2(weight[i] - highest);
        sum += weight[i];
        [[unroll]] for (uint c = 0; c < kQuads; c++) result[c] += weight[i] * v[(block + i) * kQuads + c];
      }
    }
  }

  const uint row = pixel / p.width;
  if (row < p.rowBegin || row >= p.rowEnd) return;
  const uint to = uint(texelOf(p.target, pixel)) - p.storeOrigin;
  [[unroll]] for (uint c = 0; c < kQuads; c++) target[to + c] = stored4(result[c] / sum);
}
