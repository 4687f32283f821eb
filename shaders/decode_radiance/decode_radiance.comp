// out = T^-1(clamp(base + network, 0, max(min(11, c), base))) (a + 0.02) / e; without base T^-1(network), without albedo
// no (a + 0.02). Of a colour d, d + darker min(out - d, 0) + brighter max(out - d, 0). network: [>= H, >= W, >= 4], zero
// if absent; base, d: [>= H, >= W, 4]; ceiling c: [>= H / s, >= W / s, 4]; aux: [>= H, >= W, k], a in three channels;
// out: [H, W, 4], finite; the fourth channel is 1 where the network was not and its share was left out, else 0. One
// pixel an invocation, fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/finite.glsl"
#include "shaders/common/transfer.glsl"
#include "shaders/decode_radiance/decode_radiance.h"
layout(constant_id = 0) const uint kTransfer = 0;
layout(constant_id = 1) const int kAlbedoOffset = -1;
layout(constant_id = 2) const bool kHasBase = false;
layout(constant_id = 3) const bool kHasNetwork = true;
layout(constant_id = 4) const int kCeilingScale = 0;  // 0: no ceiling
layout(constant_id = 5) const bool kHasColour = false;
layout(constant_id = 6) const float kDarker = 1;
layout(constant_id = 7) const float kBrighter = 1;
layout(binding = 0) uniform samplerBuffer network;
layout(binding = 1) uniform samplerBuffer base;
layout(binding = 2) uniform samplerBuffer ceiling;
layout(binding = 3) uniform samplerBuffer aux;
layout(binding = 4) uniform samplerBuffer colour;
layout(binding = 5) uniform samplerBuffer exposure;
#define PARAMS DecodeRadianceParams
#define TARGET_BINDING 6
#define RUN 1
#define LANE_ID 8
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  vec3 value = kHasNetwork ? texelFetch(network, texelAt(p.network, at)).rgb : vec3(0);
  const bool lost = !isFinite(value);
  value = lost ? vec3(0) : value;
  if (kHasBase) {
    const vec3 start = texelFetch(base, texelAt(p.base, at)).rgb;
    vec3 most = vec3(kTransformedMax);
    if (kCeilingScale > 0) most = min(most, texelFetch(ceiling, texelAt(p.ceiling, at / max(kCeilingScale, 1))).rgb);
    value = clamp(start + value, vec3(0), max(start, most));
  }
  vec3 factor = vec3(1);
  if (kAlbedoOffset >= 0) factor = fetchThree(aux, texelAt(p.aux, at), kAlbedoOffset) + kAlbedoEpsilon;
  value = decoded(kTransfer, value, factor, texelFetch(exposure, p.exposure).xy);
  if (kHasColour) {
    const vec3 before = max(texelFetch(colour, texelAt(p.colour, at)).rgb, vec3(0));
    const vec3 share = mix(vec3(kBrighter), vec3(kDarker), lessThan(value, before));
    value = share * value + (1 - share) * before;
  }
  storePixel(0, 0, vec4(value, lost ? 1 : 0));
}
