// out(p) = (x_h, n_h inside), (t(x_h) - t(x_p), (z_h - z_p) / max(z_h, z_p)), (a_h - a_p, 0), (normal_h - normal_p, 0):
// h at (positions(p) + 1/2) / kScale - 1/2: x = c / (a + 0.02) and n bilinear, guides cubic and within the four nearest;
// t(x) = e x / (1 + e x).
// positions: [H, W, 4]; history, present: [H, W, 12], (c, n), (a, z), (normal, 0); out: [H, W, 16]. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/cubic.glsl"
#include "shaders/warp_history/warp_history.h"
layout(constant_id = 0) const int kScale = 1;
layout(binding = 0) uniform samplerBuffer positions;
layout(binding = 1) uniform samplerBuffer history;
layout(binding = 2) uniform samplerBuffer present;
layout(binding = 3) uniform samplerBuffer exposure;
#define PARAMS WarpHistoryParams
#define TARGET_BINDING 4
#define RUN 1
#define LANE_ID 1
#include "shaders/common/image_kernel.glsl"

vec3 toned(vec3 light, float e) { return 1.0 - 1.0 / (1.0 + e * max(light, 0.0)); }

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const ivec2 size = ivec2(p.target.width, p.target.height);
  const float e = texelFetch(exposure, p.exposure).x;
  const vec3 position = texelFetch(positions, texelAt(p.positions, at)).xyz;
  const vec2 q = clamp((position.xy + 0.5) / float(kScale) - 0.5, vec2(0), vec2(size - 1));
  const ivec2 corner = ivec2(floor(q));
  const vec2 part = q - vec2(corner);

  vec4 light = vec4(0), lowest[2], highest[2];
  [[unroll]] for (int i = 0; i < 4; i++) {
    const ivec2 step = ivec2(i % 2, i / 2);
    const vec2 share = mix(1.0 - part, part, vec2(step));
    const int from = texelAt(p.history, replicated(corner + step, size));
    const vec4 colour = texelFetch(history, from);
    const vec4 guides[2] = {texelFetch(history, from + 1), texelFetch(history, from + 2)};
    light += share.x * share.y * vec4(colour.rgb / (max(guides[0].rgb, 0.0) + kAlbedoEpsilon), colour.a);
    [[unroll]] for (int g = 0; g < 2; g++) {
      lowest[g] = i == 0 ? guides[g] : min(lowest[g], guides[g]);
      highest[g] = i == 0 ? guides[g] : max(highest[g], guides[g]);
    }
  }
  const vec4 across = cubicWeights(part.x, kHistoryCubic), down = cubicWeights(part.y, kHistoryCubic);
  vec4 surface = vec4(0), normal = vec4(0);
  [[unroll]] for (int i = 0; i < 16; i++) {
    const ivec2 step = ivec2(i % 4, i / 4);
    const int from = texelAt(p.history, replicated(corner + step - 1, size));
    const float weight = across[step.x] * down[step.y];
    surface += weight * texelFetch(history, from + 1);
    normal += weight * texelFetch(history, from + 2);
  }
  surface = clamp(surface, lowest[0], highest[0]);
  normal = clamp(normal, lowest[1], highest[1]);

  const int here = texelAt(p.present, at);
  const vec3 colour = texelFetch(present, here).rgb;
  const vec4 guide = texelFetch(present, here + 1);
  const vec3 presentLight = colour / (guide.rgb + kAlbedoEpsilon);
  const float nearness = max(max(surface.a, guide.a), kHistoryNearest);
  storePixel(0, 0, vec4(light.rgb, light.a * position.z));
  storePixel(0, 1, vec4(toned(light.rgb, e) - toned(presentLight, e), (surface.a - guide.a) / nearness));
  storePixel(0, 2, vec4(surface.rgb - guide.rgb, 0));
  storePixel(0, 3, vec4(normal.xyz - texelFetch(present, here + 2).xyz, 0));
}
