// y = softmax(q k^T / sqrt(d) + bias) v as in window_attention.comp, for CPU devices.
// A subgroup takes kQueries * kLanes queries of one window and head, kQueries consecutive ones a lane, and walks over the
// keys, kKeys a step: half of the lanes hold their keys, the others their values, in kParts parts of the channels, and
// shuffles with a constant lane hand them to all. The softmax keeps a running maximum; log2(e) is in the bias and in q.
// bias: [class of the window: + 1 in the last column, + 2 in the last row][head][key / kKeys][query][kKeys], hidden keys
// -1e30, queries padded to whole subgroups. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/window_attention/window_attention.h"
layout(local_size_x_id = 0, local_size_y = 4) in;  // x = subgroup size
#define PARAMS WindowAttentionParams
#define TARGET_BINDING 4
#include "shaders/common/power2.glsl"
#include "shaders/common/uniform_store.glsl"
layout(constant_id = 1) const uint kWindow = 8;
layout(constant_id = 2) const uint kHeadChannels = 32;
layout(constant_id = 3) const uint kQueries = 4;
layout(constant_id = 4) const uint kKeys = 4;
layout(constant_id = 5) const bool kOneTensor = true;  // keys and values are slices of the same
layout(constant_id = 6) const bool kQueriesApart = false;  // they lie in another tensor than the keys
layout(constant_id = 7) const bool kAllRows = true;  // every row of the windows is stored
const uint kTokens = kWindow * kWindow;
const uint kQuads = kHeadChannels / 4;
const uint kParts = kLanes / (2 * kKeys);
const uint kPartQuads = kQuads / kParts;
const uint kSteps = (kTokens + kKeys - 1) / kKeys;
const uint kBlocks = (kTokens + kLanes * kQueries - 1) / (kLanes * kQueries);  // subgroups for a window and head
// Queries, and keys or channels of a value, whose sums stay in registers: of 8 lanes (AVX2) 16, some of them for factors.
// Loops count from 0: Mesa 25.0 does not unroll those that begin at another loop's counter.
const uint kTile = kQueries < 4 ? kQueries : 4;
const uint kPieces = kLanes <= 8 && kTile > 2 ? 2 : 1, kPiece = 4 / kPieces;
const uint kKeyPiece = kKeys < kPiece ? kKeys : kPiece;
layout(binding = 0) uniform samplerBuffer queries;
layout(binding = 1) uniform samplerBuffer keys;
layout(binding = 2) uniform samplerBuffer values;
layout(binding = 3) uniform samplerBuffer bias;

// Pixel of a token of the window whose first token lies at `corner` of the shifted image.
uvec2 pixelOf(uvec2 corner, uint token) {
  const uvec2 size = uvec2(p.width, p.height);
  const uvec2 pixel = corner + uvec2(token % kWindow, token / kWindow) + p.shift;
  return pixel - mix(uvec2(0), size, greaterThanEqual(pixel, size));
}

uint texelOf(Slice slice, uvec2 pixel, uint head) {
  return (pixel.y * p.width + pixel.x) * slice.stride + slice.offset + head * kQuads;
}

// Reads something of each cache line of the window's rows, for all heads, in the order of the memory, which a CPU
// fetches ahead; the reads of single heads and lanes jump about. Worth a quarter of the time.
float touchRows(samplerBuffer tensor, Slice slice, uvec2 corner, bool wanted) {
  float touched = 0;
  for (uint row = 0; row < (wanted ? kWindow : 0); row++) {
    const uvec2 pixel = pixelOf(corner, row * kWindow);
    const uint from = texelOf(slice, pixel, 0), lane = gl_LocalInvocationID.x * 4;
    const uint last = (min(kWindow, p.width - pixel.x) - 1) * slice.stride + p.headCount * kQuads - 1;
    for (uint n = 0; n < kWindow * slice.stride; n += kLanes * 4)
      touched += texelFetch(tensor, int(from + min(n + lane, last))).x;
  }
  return touched;
}

void main() {
  const uint lane = gl_LocalInvocationID.x;
  const uint unitsInRow = p.width / kWindow * p.headCount * kBlocks;
  const uint unit = min(gl_WorkGroupID.x * gl_WorkGroupSize.y + gl_LocalInvocationID.y, unitsInRow - 1);
  const uint block = unit % kBlocks, windowAndHead = unit / kBlocks;
  const uint column = uint((float(windowAndHead) + 0.5) / float(p.headCount));  // integers divide lane by lane
  const uint head = windowAndHead - column * p.headCount;
  const uint windowRows = p.height / kWindow, cyclicRow = p.firstWindowRow + gl_WorkGroupID.y;
  const uvec2 window = uvec2(column, cyclicRow < windowRows ? cyclicRow : cyclicRow - windowRows);
  const uvec2 corner = kWindow * window;
  const uvec2 last = uvec2(equal(window, uvec2(p.width / kWindow, windowRows) - 1));
  const uint windowClass = p.shift == 0 ? 0 : last.x + 2 * last.y;
  const uint firstQuery = (block * kLanes + lane) * kQueries;

  const bool isFirst = head == 0 && block == 0;
  float touched = touchRows(keys, p.keys, corner, isFirst);
  if (!kOneTensor) touched += touchRows(values, p.values, corner, isFirst);
  touched += touchRows(queries, p.queries, corner, isFirst && kQueriesApart);
  if (p.height == 0) storeLane(0, wide4(vec4(touched)), 0);  // never: keeps the reads alive
  vec4 q[kQueries][kQuads], result[kQueries][kQuads];
  float highest[kQueries], sum[kQueries];
  [[unroll]] for (uint i = 0; i < kQueries; i++) {
    const uint from = texelOf(p.queries, pixelOf(corner, min(firstQuery + i, kTokens - 1)), head);
    [[unroll]] for (uint c = 0; c < kQuads; c++) {
      q[i][c] = texelFetch(queries, int(from + c)) * (kLog2E * inversesqrt(float(kHeadChannels)));
      result[i][c] = vec4(0);
    }
    highest[i] = -1e30;
    sum[i] = 0;
  }

  const uint biasStep = kBlocks * kLanes * kQueries * kKeys / 4;
  uint biasFrom = (windowClass * p.headCount + head) * kSteps * biasStep + firstQuery * kKeys / 4;
  for (uint step = 0; step < kSteps; step++) {
    const uvec2 keyPixel = pixelOf(corner, min(step * kKeys + lane % kKeys, kTokens - 1));
    const uint part = lane / kKeys % kParts * kPartQuads;
    const uint keyFrom = texelOf(p.keys, keyPixel, head) + part, valueFrom = texelOf(p.values, keyPixel, head) + part;
    const bool holdsKeys = lane < kLanes / 2;
    vec4 held[kPartQuads];
    [[unroll]] for (uint c = 0; c < kPartQuads; c++) {
      held[c] = texelFetch(keys, int((holdsKeys || !kOneTensor ? keyFrom : valueFrom) + c));
      if (!kOneTensor) held[c] = holdsKeys ? held[c] : texelFetch(values, int(valueFrom + c));
    }

    float weight[kQueries][kKeys];
    [[unroll]] for (uint n = 0; n < kQueries * kKeys; n += 4) {
      const vec4 start = texelFetch(bias, int(biasFrom + n / 4));
      [[unroll]] for (uint m = 0; m < 4; m++) weight[(n + m) / kKeys][(n + m) % kKeys] = start[m];
    }
    biasFrom += biasStep;
    [[unroll]] for (uint i0 = 0; i0 < kQueries; i0 += kTile)
      [[unroll]] for (uint piece = 0; piece < kKeys / kKeyPiece; piece++)
        [[unroll]] for (uint c = 0; c < kHeadChannels; c++)
          [[unroll]] for (uint n = 0; n < kKeyPiece; n++) {
            const uint j = piece * kKeyPiece + n;
            const float key = handedOut(held[c / 4 % kPartQuads][c % 4], c / 4 / kPartQuads * kKeys + j);
            [[unroll]] for (uint i = 0; i < kTile; i++)
              weight[i0 + i][j] = plusProduct(weight[i0 + i][j], q[i0 + i][c / 4][c % 4], key);
          }

    float kept[kQueries];
    [[unroll]] for (uint i = 0; i < kQueries; i++) {
      float top = highest[i];
      [[unroll]] for (uint j = 0; j < kKeys; j++) top = weight[i][j] > top ? weight[i][j] : top;
      kept[i] = power2(highest[i] - top);
      highest[i] = top;
      sum[i] *= kept[i];
      [[unroll]] for (uint j = 0; j < kKeys; j++) {
        weight[i][j] = power2(weight[i][j] - top);
        sum[i] += weight[i][j];
      }
    }
    [[unroll]] for (uint i0 = 0; i0 < kQueries; i0 += kTile)
      [[unroll]] for (uint c = 0; c < kQuads; c++) {
        [[unroll]] for (uint i = 0; i < kTile; i++) result[i0 + i][c] *= kept[i0 + i];
        [[unroll]] for (uint piece = 0; piece < kPieces; piece++)
          [[unroll]] for (uint j = 0; j < kKeys; j++)
            [[unroll]] for (uint n = 0; n < kPiece; n++) {
              const uint o = piece * kPiece + n;
              const float value = handedOut(held[c % kPartQuads][o], kLanes / 2 + c / kPartQuads * kKeys + j);
              [[unroll]] for (uint i = 0; i < kTile; i++)
                result[i0 + i][c][o] = plusProduct(result[i0 + i][c][o], weight[i0 + i][j], value);
            }
      }
  }

  const uvec2 sameCorner = uvec2(uniformOf(corner.x, 4), uniformOf(corner.y, 4));
  const uint sameBlock = uniformOf(block, 2), sameHead = uniformOf(head, 2);
  [[unroll]] for (uint i = 0; i < kQueries; i++) {
    const float scale = 1.0 / sum[i];
    [[unroll]] for (uint c = 0; c < kQuads; c++) {
      const WIDE4 y = wide4(result[i][c] * scale);
      [[unroll]] for (uint l = 0; l < kLanes; l++) {
        const uvec2 pixel = pixelOf(sameCorner, min((sameBlock * kLanes + l) * kQueries + i, kTokens - 1));
        const uint to = texelOf(p.target, pixel, sameHead) - p.storeOrigin + c;
        if (kAllRows)
          storeLane(to, y, l);
        else if (pixel.y >= p.rowBegin && pixel.y < p.rowEnd)
          storeLane(to, y, l);
      }
    }
  }
}
