// Over the last kFlickerFrames pictures at most: m += s (x - m), v = (1 - s) (v + s |x - m|^2 / 3), s = share; deviation
// = sqrt(v), where x is the picture's sRGB value. picture, state (m, v), deviation: [height, width, 4]. One pixel an
// invocation. fp32.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "viewer/display/flicker_parameters.h"
#include "viewer/display/srgb.glsl"

layout(local_size_x = kFlickerGroup, local_size_y = kFlickerGroup) in;
layout(push_constant) uniform Push { FlickerParameters p; };
layout(binding = 0) uniform samplerBuffer picture;
layout(binding = 1, std430) buffer State { vec4 state[]; };
layout(binding = 2, std430) writeonly buffer Deviation { vec4 deviation[]; };

void main() {
  const uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= p.width || at.y >= p.height) return;
  const uint i = at.y * p.width + at.x;
  const vec4 before = state[i];
  const vec3 difference = srgb(texelFetch(picture, int(i)).rgb) - before.rgb;
  const float variance = (1.0 - p.share) * (before.a + p.share * dot(difference, difference) / 3.0);
  state[i] = vec4(before.rgb + p.share * difference, variance);
  deviation[i] = vec4(vec3(sqrt(variance)), 0);
}
