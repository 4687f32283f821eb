// out(p) = (sum w x / sum w (a + 0.02), sum w), (a, z), (normal, 0) of the sums (sum w x, sum w), (sum g a, sum g z),
// (sum g normal, sum g), each over its sum of weights; kGuided: the first quad alone, a of the guides. sums: [H, W,
// 12], guides: [H, W, >= 4], out: [H, W, 12], kGuided [H, W, 4]. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/resolve_history/resolve_history.h"
layout(constant_id = 0) const bool kGuided = false;
layout(binding = 0) uniform samplerBuffer sums;
layout(binding = 1) uniform samplerBuffer guides;
#define PARAMS ResolveHistoryParams
#define TARGET_BINDING 2
#define RUN 1
#define LANE_ID 1
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const int from = texelAt(p.sums, at);
  const vec4 light = texelFetch(sums, from);
  const vec4 facing = texelFetch(sums, from + 2);
  const float weights = max(facing.a, kHistoryLeast);
  const vec4 surface = kGuided ? texelFetch(guides, texelAt(p.guides, at)) : texelFetch(sums, from + 1) / weights;
  storePixel(0, 0, vec4(light.rgb / max(light.a, kHistoryLeast) * (max(surface.rgb, 0.0) + kAlbedoEpsilon), light.a));
  if (kGuided) return;
  storePixel(0, 1, surface);
  storePixel(0, 2, vec4(facing.xyz / weights, 0));
}
