// out = in + (x - clamp(x, 0, 1)), x the image. in, image, out: [h, w, 4]. One pixel an invocation, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/add_excess/add_excess.h"
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer image;
#define PARAMS AddExcessParams
#define TARGET_BINDING 2
#define RUN 1
#define LANE_ID 0
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const vec4 given = texelFetch(image, texelAt(p.image, at));
  storePixel(0, 0, texelFetch(source, texelAt(p.source, at)) + (given - clamp(given, 0.0, 1.0)));
}
