// out[y, x] = curve^-1(max(in[y, x], 0)) / e, e for radiance alone. in: [>= h, >= w, 4]; out: [h, w, 4], finite; the fourth
// channel is 1 where the input was not and counts as 0, else 0. One pixel an invocation, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/finite.glsl"
#include "shaders/common/frame_curve.glsl"
#include "shaders/decode_frame/decode_frame.h"
layout(constant_id = 0) const uint kCurve = 0;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer exposure;
#define PARAMS DecodeFrameParams
#define TARGET_BINDING 2
#define RUN 1
#define LANE_ID 1
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  vec3 value = texelFetch(source, texelAt(p.source, at)).rgb;
  const bool lost = !isFinite(value);
  value = uncurved(kCurve, lost ? vec3(0) : value);
  if (kCurve == kFrameHdr) value = min(value * texelFetch(exposure, p.exposure).y, vec3(kFrameMax));
  storePixel(0, 0, vec4(value, lost ? 1 : 0));
}
