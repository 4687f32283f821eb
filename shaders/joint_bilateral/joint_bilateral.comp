// out(p) = sum_i v_i x_i / sum_i v_i over the 5 x 5 low-resolution pixels i around q = (p + 0.5) / s - 0.5, with
// v_i = exp(-|q - i|^2 / (2 0.75^2)) (exp(-|n_p - m_i|^2 / (2 0.2^2) - |a_p - b_i|^2 / (2 0.5^2)) + 1e-6) exp(k_i).
// x, b, m: low resolution, read at i clamped to the real image; a, n, logits k: at p. All: [rows, columns, channels].
// An invocation makes a run of kRun pixels of a column, of one low-resolution pixel or more: they share loads. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/power2.glsl"
#include "shaders/joint_bilateral/joint_bilateral.h"
layout(constant_id = 0) const int kScale = 1;
layout(constant_id = 1) const int kRun = 1;
layout(constant_id = 2) const int kAlbedoOffset = 0;
layout(constant_id = 3) const int kNormalOffset = -1;
layout(constant_id = 4) const bool kLearned = false;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer aux;
layout(binding = 2) uniform samplerBuffer auxMean;
layout(binding = 3) uniform samplerBuffer network;
const int kPixels = (kRun + kScale - 1) / kScale;  // of low resolution
#define PARAMS JointBilateralParams
#define TARGET_BINDING 4
#define RUN kRun
#define LANE_ID 5
#include "shaders/common/guides.glsl"
#include "shaders/common/image_kernel.glsl"

// exp(-(q - i)^2 / (2 sigma^2)) along one axis, for the pixel `inside` of its low-resolution pixel and i = step - 2.
float nearness(int inside, int step) {
  const float distance = (float(inside) + 0.5) / float(kScale) - 0.5 - float(step - 2);
  return power2(distance * distance * (-0.5 * kLog2E / (kSigmaSpace * kSigmaSpace)));
}

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const ivec2 centre = at / kScale;
  // A run of whole low-resolution pixels begins with one: a constant, of which nearness() is one too.
  const int insideRow = kRun % kScale == 0 ? 0 : at.y % kScale;
  const ivec2 size = ivec2(p.target.width, p.target.height) / kScale;

  Guide guides[kRun];
  vec3 sums[kRun];
  float totals[kRun];
  vec4 logits[kRun];
  [[unroll]] for (int r = 0; r < kRun; r++) {
    guides[r] = guideAt(aux, texelAt(p.aux, at + ivec2(0, r)));
    sums[r] = vec3(0);
    totals[r] = 0.0;
  }

  [[unroll]] for (int i = 0; i < 5 * (5 + kPixels - 1); i++) {
    if (i % 8 == 1) waitForTurn();
    const ivec2 neighbour = replicated(centre + ivec2(i % 5, i / 5) - 2, size);
    const Guide mean = guideAt(auxMean, texelAt(p.auxMean, neighbour));
    const vec3 value = texelFetch(source, texelAt(p.source, neighbour)).rgb;
    const float column = nearness(at.x % kScale, i % 5);
    [[unroll]] for (int r = 0; r < kRun; r++) {
      const int j = i - 5 * (r / kScale);  // the neighbour's number as the pixel r of the run counts
      if (j >= 0 && j < 25) {
        float weight =
            column * nearness((insideRow + r) % kScale, j / 5) * (likeness(guides[r], mean) + kBilateralFloor);
        if (kLearned) {
          const int channel = j + kFirstLogit;
          if (j == 0 || channel % 4 == 0)
            logits[r] = texelFetch(network, texelAt(p.network, at + ivec2(0, r)) + channel / 4);
          weight *= power2(kLog2E * boundedLogit(logits[r][channel % 4]));
        }
        sums[r] += weight * value;
        totals[r] += weight;
      }
    }
  }

  [[unroll]] for (int r = 0; r < kRun; r++) storePixel(r, 0, vec4(sums[r] / totals[r], 0));
}
