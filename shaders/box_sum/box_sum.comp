// out[y, x] = sum over dy, dx < s of in[s y + dy, s x + dx].
// in: [s h, s w, c], out: [h, w, c] slices. One output pixel an invocation, a vec4 at a time, fp32 sums.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/box_sum/box_sum.h"
layout(constant_id = 0) const int kChannels = 4;
layout(constant_id = 1) const int kScale = 1;
layout(binding = 0) uniform samplerBuffer source;
#define PARAMS BoxSumParams
#define TARGET_BINDING 1
#define RUN 1
#define LANE_ID 2
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const int from = texelAt(p.source, at * kScale);
  [[unroll]] for (int q = 0; q < kChannels / 4; q++) {
    vec4 sum = vec4(0);
    for (int dy = 0; dy < kScale; dy++)
      for (int dx = 0; dx < kScale; dx++)
        sum += texelFetch(source, from + (dy * p.source.width + dx) * p.source.stride + q);
    storePixel(0, q, sum);
  }
}
