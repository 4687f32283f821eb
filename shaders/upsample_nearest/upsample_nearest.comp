// out[y, x] = in[y / 2, x / 2]. in: [h, w, c], out: [2h, 2w, c] slices. One output pixel an invocation, a vec4 at a time.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/upsample_nearest/upsample_nearest.h"
layout(constant_id = 0) const int kChannels = 4;
layout(binding = 0) uniform samplerBuffer source;
#define PARAMS UpsampleNearestParams
#define TARGET_BINDING 1
#define RUN 1
#define LANE_ID 1
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const int from = texelAt(p.source, at >> 1);
  [[dont_unroll]] for (int q = 0; q < kChannels / 4; q++) storePixel(0, q, texelFetch(source, from + q));
}
