// out(p) = T(e sum_t v_t I_t / (sum_t v_t b_t + 0.02 sum_t v_t)) over 25 taps t = p + 3^k j of each level k, |j| <= 2,
// with v_t = exp(-|j|^2 / (2 1.8^2)) (exp(-|n_p - m_t|^2 / (2 0.2^2) - |b_p - b_t|^2 / (2 0.5^2)) + 1e-6) exp(l_t).
// colour I, aux b, m of level 0: [rows, columns, channels]; of the levels above both, one behind the other; logits l at
// p. Taps are clamped to the real image; weights are scaled to sum to at most 1. One pixel an invocation, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/power2.glsl"
#include "shaders/common/transfer.glsl"
#include "shaders/prefilter/prefilter.h"
layout(constant_id = 0) const int kLevels = 1;
layout(constant_id = 1) const int kAuxQuads = 1;  // c / 4
layout(constant_id = 2) const int kAlbedoOffset = 0;
layout(constant_id = 3) const int kNormalOffset = -1;
layout(constant_id = 4) const uint kTransfer = 0;
layout(binding = 0) uniform samplerBuffer colour;
layout(binding = 1) uniform samplerBuffer auxMean;
layout(binding = 2) uniform samplerBuffer coarser;
layout(binding = 3) uniform samplerBuffer logits;
layout(binding = 4) uniform samplerBuffer exposure;
#define PARAMS PrefilterParams
#define TARGET_BINDING 5
#define RUN 1
#define LANE_ID 5
#include "shaders/common/guides.glsl"
#include "shaders/common/image_kernel.glsl"

// log2 of what the largest weights are divided by: 75 e^8.
const float kWeightScale = 18.0;

// exp(-d^2 / (2 sigma^2)) of a distance in steps along one axis.
float nearness(int steps) {
  return power2(float(steps * steps) * (-0.5 * kLog2E / (kSigmaPrefilter * kSigmaPrefilter)));
}

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const ivec2 size = ivec2(p.target.width, p.target.height);
  const Guide own = guideAt(auxMean, texelAt(p.auxMean, at));
  const int logitTexel = texelAt(p.logits, at);
  vec3 colourSum = vec3(0), albedoSum = vec3(0);
  float total = 0.0;
  vec4 four;
  int spacing = 1;
  [[unroll]] for (int level = 0; level < kLevels; level++) {
    [[unroll]] for (int j = 0; j < kPrefilterTaps; j++) {
      const ivec2 steps = ivec2(j % 5, j / 5) - 2;
      const ivec2 tap = replicated(at + spacing * steps, size);
      vec3 radiance, albedo;
      Guide guide;
      if (level == 0) {
        const int texel = texelAt(p.auxMean, tap);
        radiance = texelFetch(colour, texelAt(p.colour, tap)).rgb;
        albedo = fetchThree(auxMean, texel, kAlbedoOffset);
        guide = guideAt(auxMean, texel);
      } else {
        const int texel = texelAt(p.coarser, tap) + (level - 1) * (1 + kAuxQuads);
        radiance = texelFetch(coarser, texel).rgb;
        albedo = fetchThree(coarser, texel + 1, kAlbedoOffset);
        guide = guideAt(coarser, texel + 1);
      }
      const int channel = kPrefilterTaps * level + j;
      if (channel % 4 == 0) four = texelFetch(logits, logitTexel + channel / 4);
      const float weight = nearness(steps.x) * nearness(steps.y) * (likeness(own, guide) + kBilateralFloor) *
                           power2(kLog2E * boundedLogit(four[channel % 4]) - kWeightScale);
      colourSum += weight * max(radiance, 0.0);
      albedoSum += weight * albedo;
      total += weight;
    }
    spacing *= kPrefilterStep;
  }
  const vec3 x =
      encoded(kTransfer, colourSum / total, texelFetch(exposure, p.exposure).x, albedoSum / total + kAlbedoEpsilon);
  storePixel(0, 0, vec4(x, 0));
}
