// out(p) = (q + m(q), inside, 0): q the position of p so far, or p itself (kFirst), m the motion at the pixel next to
// q, inside 1 as long as no position was outside of the image. positions, motion, out: [H, W, 4]. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/follow_motion/follow_motion.h"
layout(constant_id = 0) const bool kFirst = false;
layout(binding = 0) uniform samplerBuffer positions;
layout(binding = 1) uniform samplerBuffer motion;
#define PARAMS FollowMotionParams
#define TARGET_BINDING 2
#define RUN 1
#define LANE_ID 1
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const ivec2 size = ivec2(p.target.width, p.target.height);
  const vec3 q = kFirst ? vec3(at, 1) : texelFetch(positions, texelAt(p.positions, at)).xyz;
  const ivec2 from = replicated(ivec2(floor(q.xy + 0.5)), size);
  const vec2 next = q.xy + texelFetch(motion, texelAt(p.motion, from)).xy;
  const bool inside = all(greaterThan(next, vec2(-0.5))) && all(lessThan(next, vec2(size) - 0.5));
  storePixel(0, 0, vec4(next, inside ? q.z : 0.0, 0));
}
