// out = T^-1(clamp(base + network, 0, 11)) (a + 0.02) / e; without base T^-1(network), without albedo no (a + 0.02).
// network: [>= H, >= W, >= 4], zero if absent; base: [>= H, >= W, 4]; aux: [>= H, >= W, c], a in three channels;
// out: [H, W, 4]. One pixel an invocation, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/image.glsl"
#include "shaders/common/storage.glsl"
#include "shaders/common/transfer.glsl"
#include "shaders/decode_radiance/decode_radiance.h"
layout(local_size_x = kImageGroupWidth, local_size_y = kImageGroupHeight) in;
layout(constant_id = 0) const uint kTransfer = 0;
layout(constant_id = 1) const int kAlbedoOffset = -1;
layout(constant_id = 2) const bool kHasBase = false;
layout(constant_id = 3) const bool kHasNetwork = true;
layout(binding = 0) uniform samplerBuffer network;
layout(binding = 1) uniform samplerBuffer base;
layout(binding = 2) uniform samplerBuffer aux;
layout(binding = 3) uniform samplerBuffer exposure;
layout(binding = 4, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { DecodeRadianceParams p; };

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, p.rows.begin);
  if (at.x >= p.target.width || at.y >= p.rows.end) return;
  vec3 value = kHasNetwork ? texelFetch(network, texelAt(p.network, at)).rgb : vec3(0);
  if (kHasBase) value = clamp(texelFetch(base, texelAt(p.base, at)).rgb + value, 0.0, kTransformedMax);
  value = inverseTransform(kTransfer, value);
  if (kAlbedoOffset >= 0) value *= fetchThree(aux, texelAt(p.aux, at), kAlbedoOffset) + kAlbedoEpsilon;
  value *= texelFetch(exposure, p.exposure).y;
  target[texelAt(p.target, at) - p.rows.storeOrigin] = stored4(vec4(value, 0));
}
