// out[y, x] = max of in[2y .. 2y + 1, 2x .. 2x + 1], channel by channel. in: [2h, 2w, c], out: [h, w, c] slices.
// One output pixel an invocation, a vec4 at a time.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/max_pool/max_pool.h"
layout(constant_id = 0) const int kChannels = 4;
layout(binding = 0) uniform samplerBuffer source;
#define PARAMS MaxPoolParams
#define TARGET_BINDING 1
#define RUN 1
#define LANE_ID 1
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const int above = texelAt(p.source, 2 * at), below = texelAt(p.source, 2 * at + ivec2(0, 1)), right = p.source.stride;
  [[dont_unroll]] for (int q = 0; q < kChannels / 4; q++) {
    const vec4 upper = max(texelFetch(source, above + q), texelFetch(source, above + right + q));
    const vec4 lower = max(texelFetch(source, below + q), texelFetch(source, below + right + q));
    storePixel(0, q, max(upper, lower));
  }
}
