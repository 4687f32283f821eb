// out(p) = (1 - g) base(p) + g T(e sum_j v_j H_j / (sum_j v_j a_j + 0.02 sum_j v_j)), v_j = exp(l_j), over the m x m
// pixels j around p, clamped to the real image; g = 1 / (1 + exp(-l_m^2)). images: [>= H, >= W, k] with H, aux: [>= H,
// >= W, c] with a in three channels, network: logits l of p from kFirstLogit on (row-major, within +-8), base, out: [H,
// W, 4]. Weights are scaled to sum to at most 1. An invocation makes a run of kRun pixels of a column, which share
// loads. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/blend_colour/blend_colour.h"
#include "shaders/common/power2.glsl"
#include "shaders/common/transfer.glsl"
layout(constant_id = 0) const int kSide = 3;  // m
layout(constant_id = 1) const int kFirstLogit = 3;
layout(constant_id = 2) const int kColourOffset = 0;
layout(constant_id = 3) const int kAlbedoOffset = 0;
layout(constant_id = 4) const uint kTransfer = 0;
layout(constant_id = 5) const int kRun = 1;
layout(binding = 0) uniform samplerBuffer base;
layout(binding = 1) uniform samplerBuffer images;
layout(binding = 2) uniform samplerBuffer aux;
layout(binding = 3) uniform samplerBuffer network;
layout(binding = 4) uniform samplerBuffer exposure;
#define PARAMS BlendColourParams
#define TARGET_BINDING 5
#define RUN kRun
#define LANE_ID 6
#include "shaders/common/image_kernel.glsl"

// log2 of what weights are divided by: 25 e^8.
const float kWeightScale = 17.0;

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const ivec2 size = ivec2(p.target.width, p.target.height);
  const float e = texelFetch(exposure, p.exposure).x;

  int logitTexels[kRun];
  vec4 logits[kRun];
  vec3 colours[kRun], albedos[kRun];
  float totals[kRun];
  [[unroll]] for (int r = 0; r < kRun; r++) {
    logitTexels[r] = texelAt(p.network, replicated(at + ivec2(0, r), size));
    colours[r] = albedos[r] = vec3(0);
    totals[r] = 0.0;
  }

  [[unroll]] for (int i = 0; i < (kSide + kRun - 1) * kSide; i++) {
    if (i > 0 && i % 15 == 0) waitForTurn();
    const ivec2 from = replicated(at + ivec2(i % kSide, i / kSide) - kSide / 2, size);
    const vec3 radiance = max(fetchThree(images, texelAt(p.images, from), kColourOffset), 0.0);
    const vec3 albedo = fetchThree(aux, texelAt(p.aux, from), kAlbedoOffset);
    [[unroll]] for (int r = 0; r < kRun; r++) {
      const int j = i - r * kSide;  // the neighbour's number as the pixel r of the run counts
      if (j >= 0 && j < kSide * kSide) {
        const int channel = kFirstLogit + j;
        if (j == 0 || channel % 4 == 0) logits[r] = texelFetch(network, logitTexels[r] + channel / 4);
        const float weight = power2(kLog2E * boundedLogit(logits[r][channel % 4]) - kWeightScale);
        colours[r] += weight * radiance;
        albedos[r] += weight * albedo;
        totals[r] += weight;
      }
    }
  }

  const int last = kFirstLogit + kSide * kSide;
  [[unroll]] for (int r = 0; r < kRun; r++) {
    const ivec2 pixel = replicated(at + ivec2(0, r), size);
    const float share =
        1.0 / (1.0 + power2(-kLog2E * boundedShare(texelFetch(network, logitTexels[r] + last / 4)[last % 4])));
    const vec3 found = encoded(kTransfer, colours[r] / totals[r], e, albedos[r] / totals[r] + kAlbedoEpsilon);
    storePixel(r, 0, vec4(mix(texelFetch(base, texelAt(p.base, pixel)).rgb, found, share), 0));
  }
}
