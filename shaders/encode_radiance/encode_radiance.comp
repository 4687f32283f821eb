// x = T(e I / (b + 0.02)), or T(e I) without an albedo, at the pixel of the real image that is nearest to the padded one,
// or its mirror image.
// colour: [h, w, 4], auxMean: [hp, wp, c] with b in three channels, out: [hp, wp, 4]. One pixel an invocation, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/transfer.glsl"
#include "shaders/encode_radiance/encode_radiance.h"
layout(constant_id = 0) const uint kTransfer = 0;
layout(constant_id = 1) const int kAlbedoOffset = -1;
layout(constant_id = 2) const bool kReflects = false;
layout(binding = 0) uniform samplerBuffer colour;
layout(binding = 1) uniform samplerBuffer exposure;
layout(binding = 2) uniform samplerBuffer auxMean;
#define PARAMS EncodeRadianceParams
#define TARGET_BINDING 3
#define RUN 1
#define LANE_ID 3
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const ivec2 size = ivec2(p.colour.width, p.colour.height);
  const ivec2 from = kReflects ? reflected(at, size) : replicated(at, size);
  const vec3 radiance = texelFetch(colour, texelAt(p.colour, from)).rgb;
  vec3 divisor = vec3(1);
  if (kAlbedoOffset >= 0) divisor = fetchThree(auxMean, texelAt(p.auxMean, from), kAlbedoOffset) + kAlbedoEpsilon;
  const vec3 x = encoded(kTransfer, radiance, texelFetch(exposure, p.exposure).x, divisor);
  storePixel(0, 0, vec4(x, 0));
}
