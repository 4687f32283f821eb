// y = softmax(q k^T / sqrt(d) + bias) v over the tokens of each window and head; bias is read at the relative position.
// q, k, v, y: [h][w][c] slices, head n in channels [n d, (n + 1) d); table: [(2 window - 1)^2][heads], padded to vec4.
// One query of one head an invocation, x within a row of windows; one pass over the keys with a running maximum, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/storage.glsl"
#include "shaders/window_attention/window_attention.h"
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kWindow = 8;
layout(constant_id = 1) const uint kHeadChannels = 32;
const uint kTokens = kWindow * kWindow;
const uint kQuads = kHeadChannels / 4;
layout(binding = 0) uniform samplerBuffer queries;
layout(binding = 1) uniform samplerBuffer keys;
layout(binding = 2) uniform samplerBuffer values;
layout(binding = 3) uniform samplerBuffer table;
layout(binding = 4, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { WindowAttentionParams p; };

// Which of the bands that the shift keeps apart a position of the shifted image lies in, for y and x.
uvec2 regionOf(uvec2 position) {
  const uvec2 size = uvec2(p.width, p.height);
  return uvec2(greaterThanEqual(position, size - kWindow)) + uvec2(greaterThanEqual(position, size - p.shift));
}

uint pixelOf(uvec2 position) {
  const uvec2 unshifted = (position + p.shift) % uvec2(p.width, p.height);
  return unshifted.y * p.width + unshifted.x;
}

// First texel of the pixel's channels of this head.
int texelOf(Slice slice, uint pixel) {
  return int(pixel * slice.stride + slice.offset + gl_GlobalInvocationID.z * kQuads);
}

float biasOf(uvec2 query, uint key) {
  const uvec2 relative = query + (kWindow - 1) - uvec2(key % kWindow, key / kWindow);
  const uint entry = (relative.y * (2 * kWindow - 1) + relative.x) * p.headCount + gl_GlobalInvocationID.z;
  return texelFetch(table, int(entry / 4))[entry % 4];
}

void main() {
  if (gl_GlobalInvocationID.x >= p.width * kWindow) return;
  const uint token = gl_GlobalInvocationID.x % kTokens;
  const uint windowRow = (p.firstWindowRow + gl_GlobalInvocationID.y) % (p.height / kWindow);
  const uvec2 corner = kWindow * uvec2(gl_GlobalInvocationID.x / kTokens, windowRow);
  const uvec2 query = uvec2(token % kWindow, token / kWindow);
  const uvec2 region = regionOf(corner + query);
  const uint pixel = pixelOf(corner + query);

  vec4 q[kQuads], result[kQuads];
  const int from = texelOf(p.queries, pixel);
  [[unroll]] for (uint c = 0; c < kQuads; c++) {
    q[c] = texelFetch(queries, from + int(c)) * inversesqrt(float(kHeadChannels));
    result[c] = vec4(0);
  }
  float highest = -1e30, sum = 0;
  for (uint key = 0; key < kTokens; key++) {
    const uvec2 position = corner + uvec2(key % kWindow, key / kWindow);
    if (regionOf(position) != region) continue;
    const uint keyPixel = pixelOf(position);
    const int keyFrom = texelOf(p.keys, keyPixel), valueFrom = texelOf(p.values, keyPixel);
    vec4 products = vec4(0);
    [[unroll]] for (uint c = 0; c < kQuads; c++) products += q[c] * texelFetch(keys, keyFrom + int(c));
    const float score = dot(products, vec4(1)) + biasOf(query, key);
    const float before = highest;
    highest = max(highest, score);
    const float kept = exp(before - highest), weight = exp(score - highest);
    sum = sum * kept + weight;
    [[unroll]] for (uint c = 0; c < kQuads; c++)
      result[c] = result[c] * kept + weight * texelFetch(values, valueFrom + int(c));
  }

  const uint row = pixel / p.width;
  if (row < p.rowBegin || row >= p.rowEnd) return;
  const uint to = uint(texelOf(p.target, pixel)) - p.storeOrigin;
  [[unroll]] for (uint c = 0; c < kQuads; c++) target[to + c] = stored4(result[c] / sum);
}
