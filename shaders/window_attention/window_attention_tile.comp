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

const uint kTokens = gl_WorkGroupSize.x, kQuads = kHeadChannels / 4;
shared vec4 k[kKeys * kQuads], v[kKeys * kQuads];
shared uint regions[kKeys], behind[kKeys];  // of a key; by how much its bias lies before that of key 0
#include "shaders/window_attention/window.glsl"

// Keys, values and regions from that key on; zero behind the last.
void stageKeys(uvec2 origin, uint first) {
  for (uint i = gl_LocalInvocationIndex; i < kKeys * kQuads; i += kTokens) {
    const uint key = first + i / kQuads, pixel = pixelOf(origin + inWindow(min(key, kTokens - 1)));
    const vec4 keyTexel = texelFetch(keys, texelOf(p.keys, pixel) + int(i % kQuads));
    const vec4 valueTexel = texelFetch(values, texelOf(p.values, pixel) + int(i % kQuads));
    k[i] = key < kTokens ? keyTexel : vec4(0);
    v[i] = key < kTokens ? valueTexel : vec4(0);
  }
  for (uint i = gl_LocalInvocationIndex; i < kKeys; i += kTokens) {
    const uvec2 key = inWindow(min(first + i, kTokens - 1));
    regions[i] = first + i >= kTokens ? ~0u : kShifted ? regionOf(origin + key) : 0;
    behind[i] = biasesBehind(key);
  }
}

void main() {
  const uvec2 origin = corner(), query = inWindow(gl_LocalInvocationIndex);
  const uint region = kShifted ? regionOf(origin + query) : 0, pixel = pixelOf(origin + query);
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
    stageKeys(origin, first);
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
