// out(p) = sum_j exp(l_j) a_j / sum_j exp(l_j) over the m x m pixels j around p, clamped to the real image.
// aux a: [>= H, >= W, c]; network: [>= H, >= W, ...], logits l of p from kFirstLogit on (row-major, within +-8);
// out: [H, W, c]. An invocation makes a run of kRun pixels of a column: they share the loads of a. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/power2.glsl"
#include "shaders/filter_auxiliary/filter_auxiliary.h"
layout(constant_id = 0) const int kQuads = 1;  // c / 4
layout(constant_id = 1) const int kSide = 3;   // m
layout(constant_id = 2) const int kFirstLogit = 3;
layout(constant_id = 3) const int kRun = 1;
layout(binding = 0) uniform samplerBuffer aux;
layout(binding = 1) uniform samplerBuffer network;
#define PARAMS FilterAuxiliaryParams
#define TARGET_BINDING 2
#define RUN kRun
#define LANE_ID 4
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
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
        const float weight = power2(kLog2E * boundedLogit(logits[r][channel % 4]));
        [[unroll]] for (int q = 0; q < kQuads; q++) sums[r * kQuads + q] += weight * values[q];
        totals[r] += weight;
      }
    }
  }

  [[unroll]] for (int r = 0; r < kRun; r++) {
    [[unroll]] for (int q = 0; q < kQuads; q++) storePixel(r, q, sums[r * kQuads + q] / totals[r]);
  }
}
