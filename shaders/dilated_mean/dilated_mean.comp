// out[y, x] = sum over dy, dx = -1 .. 1 of in[y + n dy, x + n dx] / 9, clamped to the real image, n the step.
// in: [>= h, >= w, c], out: [h, w, c] slices. One output pixel an invocation, a vec4 at a time, fp32 sums.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/dilated_mean/dilated_mean.h"
layout(constant_id = 0) const int kChannels = 4;
layout(constant_id = 1) const int kStep = 1;
layout(binding = 0) uniform samplerBuffer source;
#define PARAMS DilatedMeanParams
#define TARGET_BINDING 1
#define RUN 1
#define LANE_ID 2
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const ivec2 size = ivec2(p.target.width, p.target.height);
  [[unroll]] for (int q = 0; q < kChannels / 4; q++) {
    vec4 sum = vec4(0);
    [[unroll]] for (int j = 0; j < 9; j++) {
      const ivec2 from = replicated(at + kStep * (ivec2(j % 3, j / 3) - 1), size);
      sum += texelFetch(source, texelAt(p.source, from) + q) * (1.0 / 9.0);
    }
    storePixel(0, q, sum);
  }
}
