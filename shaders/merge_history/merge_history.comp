// out(p) = sums(p) + (w x, w), (g a, g z), (g normal, g): g = n exp(-|mean a'|^2 / 0.2^2 - |mean normal'|^2 / 0.35^2 -
// (mean z')^2 / 0.1^2) over 3 x 3 pixels, w = g / (1 + r + r^2), r = 6 n b / v, v = n k / (n + k) sum_c var(t_c), k the count
// of the present pixel, b = sum_c max(0, mean(t_c)^2 - l var(t_c) / N) over N = (2 kRadius + 1)^2, l = n / k in [1, 4].
// warped: [H, W, 16], (x, n), (t, z'), (a', 0), (normal', 0), primes for differences from the present frame; present,
// sums, out: [H, W, 12]. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/power2.glsl"
#include "shaders/merge_history/merge_history.h"
layout(constant_id = 0) const int kRadius = 2;
layout(constant_id = 1) const bool kFirst = false;  // no sums so far
layout(binding = 0) uniform samplerBuffer warped;
layout(binding = 1) uniform samplerBuffer present;
layout(binding = 2) uniform samplerBuffer sums;
#define PARAMS MergeHistoryParams
#define TARGET_BINDING 3
#define RUN 1
#define LANE_ID 2
#include "shaders/common/image_kernel.glsl"

float squaredLength(vec3 v) { return dot(v, v); }

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const ivec2 size = ivec2(p.target.width, p.target.height);

  vec3 mean = vec3(0), square = vec3(0), albedo = vec3(0), normal = vec3(0);
  float nearness = 0.0;
  for (int dy = -kRadius; dy <= kRadius; dy++)
    for (int dx = -kRadius; dx <= kRadius; dx++) {
      const int from = texelAt(p.warped, replicated(at + ivec2(dx, dy), size));
      const vec4 difference = texelFetch(warped, from + 1);
      mean += difference.rgb;
      square += difference.rgb * difference.rgb;
      if (abs(dx) <= 1 && abs(dy) <= 1) {
        nearness += difference.a;
        albedo += texelFetch(warped, from + 2).rgb;
        normal += texelFetch(warped, from + 3).xyz;
      }
    }
  const float count = float((2 * kRadius + 1) * (2 * kRadius + 1));
  mean /= count;
  const vec3 variance = max(square / count - mean * mean, 0.0);

  const int here = texelAt(p.warped, at);
  const vec4 light = texelFetch(warped, here);
  const float part = squaredLength(albedo / (9.0 * kHistoryAlbedo)) + squaredLength(normal / (9.0 * kHistoryNormal)) +
                     squaredLength(vec3(nearness / (9.0 * kHistoryNearness), 0, 0));
  const float guideWeight = light.a * power2(-kLog2E * min(part, 80.0));
  const int frame = texelAt(p.present, at);
  const vec4 colour = texelFetch(present, frame), surface = texelFetch(present, frame + 1);
  const float both = max(light.a + colour.a, kHistoryLeast);
  const float noise = dot(variance, vec3(1)) * light.a * colour.a / both + kHistoryNoise;
  const float luck = clamp(light.a / max(colour.a, kHistoryLeast), 1.0, kHistoryLuck);
  const float bias = dot(max(mean * mean - luck * variance / count, 0.0), vec3(1));
  const float ratio = kHistoryBias * light.a * bias / noise;
  const float weight = guideWeight / (1.0 + ratio + ratio * ratio);

  const vec3 facing = texelFetch(present, frame + 2).xyz;
  const vec4 first[3] = {vec4(colour.rgb / (max(surface.rgb, 0.0) + kAlbedoEpsilon), 1) * colour.a, surface * colour.a,
                         vec4(facing, 1) * colour.a};
  const vec4 further[3] = {weight * vec4(light.rgb, 1),
                           guideWeight * vec4(surface.rgb + texelFetch(warped, here + 2).rgb, surface.a),
                           guideWeight * vec4(facing + texelFetch(warped, here + 3).xyz, 1)};
  const int sum = texelAt(p.sums, at);
  [[unroll]] for (int quad = 0; quad < 3; quad++)
      storePixel(0, quad, (kFirst ? first[quad] : texelFetch(sums, sum + quad)) + further[quad]);
}
