// x = T(e I / (b + 0.02)), or T(e I) without an albedo, at the pixel of the real image nearest to the padded one.
// colour: [h, w, 4], auxMean: [hp, wp, c] with b in three channels, out: [hp, wp, 4]. One pixel an invocation, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/image.glsl"
#include "shaders/common/storage.glsl"
#include "shaders/common/transfer.glsl"
#include "shaders/encode_radiance/encode_radiance.h"
layout(local_size_x = kImageGroupWidth, local_size_y = kImageGroupHeight) in;
layout(constant_id = 0) const uint kTransfer = 0;
layout(constant_id = 1) const int kAlbedoOffset = -1;
layout(binding = 0) uniform samplerBuffer colour;
layout(binding = 1) uniform samplerBuffer exposure;
layout(binding = 2) uniform samplerBuffer auxMean;
layout(binding = 3, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { EncodeRadianceParams p; };

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, p.rows.begin);
  if (at.x >= p.target.width || at.y >= p.rows.end) return;
  const ivec2 from = replicated(at, ivec2(p.colour.width, p.colour.height));
  vec3 value = texelFetch(colour, texelAt(p.colour, from)).rgb * texelFetch(exposure, p.exposure).x;
  if (kAlbedoOffset >= 0) value /= fetchThree(auxMean, texelAt(p.auxMean, from), kAlbedoOffset) + kAlbedoEpsilon;
  target[texelAt(p.target, at) - p.rows.storeOrigin] = stored4(vec4(transform(kTransfer, value), 0));
}
