// out(p) = sum_j exp(l_j) a_j / sum_j exp(l_j) over the m x m pixels j around p, clamped to the real image.
// aux a: [>= H, >= W, c]; network: [>= H, >= W, ...], logits l of p from kFirstLogit on (row-major, within +-8);
// out: [H, W, c]. An invocation makes a run of kRun pixels of a column: they share the loads of a. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/image.glsl"
#include "shaders/common/storage.glsl"
#include "shaders/filter_auxiliary/filter_auxiliary.h"
layout(local_size_x = kImageGroupWidth, local_size_y = kImageGroupHeight) in;
layout(constant_id = 0) const int kQuads = 1;  // c / 4
layout(constant_id = 1) const int kSide = 3;   // m
layout(constant_id = 2) const int kFirstLogit = 3;
layout(constant_id = 3) const int kRun = 1;
layout(binding = 0) uniform samplerBuffer aux;
layout(binding = 1) uniform samplerBuffer network;
layout(binding = 2, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { FilterAuxiliaryParams p; };

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.x, p.rows.begin + kRun * int(gl_GlobalInvocationID.y));
  if (at.x >= p.target.width || at.y >= p.rows.end) return;
  const ivec2 size = ivec2(p.target.width, p.target.height);

  int logitTexels[kRun];
  vec4 logits[kRun];
  vec4 sums[kRun * kQuads];
  float totals[kRun];
  [[unroll]] for (int r = 0; r < kRun; r++) {
    logitTexels[r] = texelAt(p.network, replicated(at + ivec2(0, r), size));
    totals[r] = 0.0;
    [[unroll]] for (int q = 0; q < kQuads; q++) sums[r * kQuads + q] = vec4(0);
  }

  [[unroll]] for (int i = 0; i < (kSide + kRun - 1) * kSide; i++) {
    const int from = texelAt(p.aux, replicated(at + ivec2(i % kSide, i / kSide) - kSide / 2, size));
    vec4 values[kQuads];
    [[unroll]] for (int q = 0; q < kQuads; q++) values[q] = texelFetch(aux, from + q);
    [[unroll]] for (int r = 0; r < kRun; r++) {
      const int j = i - r * kSide;  // the neighbour's number as the pixel r of the run counts
      if (j >= 0 && j < kSide * kSide) {
        const int channel = kFirstLogit + j;
        if (j == 0 || channel % 4 == 0) logits[r] = texelFetch(network, logitTexels[r] + channel / 4);
        const float weight = exp(clamp(logits[r][channel % 4], -kLogitMax, kLogitMax));
        [[unroll]] for (int q = 0; q < kQuads; q++) sums[r * kQuads + q] += weight * values[q];
        totals[r] += weight;
      }
    }
  }

  [[unroll]] for (int r = 0; r < kRun; r++) {
    if (at.y + r >= p.rows.end) break;
    const int to = texelAt(p.target, at + ivec2(0, r)) - p.rows.storeOrigin;
    [[unroll]] for (int q = 0; q < kQuads; q++) target[to + q] = stored4(sums[r * kQuads + q] / totals[r]);
  }
}
