// out(p) = (x_h, n_h inside), (t(x_h) - t(x_p), (z_h - z_p) / max(z_h, z_p)), (a_h - a_p, 0), (normal_h - normal_p, 0):
// h at (positions(p) + 1/2) / kScale - 1/2, cubic and within the four nearest pixels: x = c / (a + 0.02), n and guides;
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

  const vec4 across = cubicWeights(part.x, kHistoryCubic), down = cubicWeights(part.y, kHistoryCubic);
  vec4 sums[3], lowest[3], highest[3];
  [[unroll]] for (int i = 0; i < 16; i++) {
    const ivec2 step = ivec2(i % 4, i / 4);
    const int from = texelAt(p.history, replicated(corner + step - 1, size));
    const vec4 colour = texelFetch(history, from), surface = texelFetch(history, from + 1);
    const vec4 values[3] = {vec4(colour.rgb / (max(surface.rgb, 0.0) + kAlbedoEpsilon), colour.a), surface,
                            texelFetch(history, from + 2)};
    const bool isNear = step.x % 3 > 0 && step.y % 3 > 0, isFirst = i == 5;  // of the four nearest
    [[unroll]] for (int quad = 0; quad < 3; quad++) {
      const vec4 weighted = across[step.x] * down[step.y] * values[quad];
      sums[quad] = i == 0 ? weighted : sums[quad] + weighted;
      if (isNear) {
        lowest[quad] = isFirst ? values[quad] : min(lowest[quad], values[quad]);
        highest[quad] = isFirst ? values[quad] : max(highest[quad], values[quad]);
      }
    }
  }
  const vec4 light = clamp(sums[0], lowest[0], highest[0]), surface = clamp(sums[1], lowest[1], highest[1]);
  const vec4 normal = clamp(sums[2], lowest[2], highest[2]);

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
