// out = T(g T^-1(m)), m = the largest x of the 5 x 5 pixels around, in each channel, at least 0. With T = log(1 + x) that
// is m + log(1 + (g - 1) (1 - exp(-m))), which neither overflows nor loses digits near 0. x: [>= h, >= w, 4], out:
// [h, w, 4]. One pixel an invocation, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/transfer.glsl"
#include "shaders/radiance_ceiling/radiance_ceiling.h"
layout(constant_id = 0) const uint kTransfer = 0;
layout(binding = 0) uniform samplerBuffer source;
#define PARAMS RadianceCeilingParams
#define TARGET_BINDING 1
#define RUN 1
#define LANE_ID 1
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const ivec2 size = ivec2(p.target.width, p.target.height);
  vec3 largest = vec3(0);
  [[unroll]] for (int dy = -kCeilingReach; dy <= kCeilingReach; dy++)
    [[unroll]] for (int dx = -kCeilingReach; dx <= kCeilingReach; dx++)
      largest = max(largest, texelFetch(source, texelAt(p.source, replicated(at + ivec2(dx, dy), size))).rgb);
  const vec3 ceiling = kTransfer == kTransferLog1p
                           ? largest + log1p((kCeilingFactor - 1.0) * -expm1(-largest))
                           : kCeilingFactor * largest;
  storePixel(0, 0, vec4(ceiling, 0));
}
