// out[y, x] = in[min(y, H - 1), min(x, W - 1)], the albedo's three channels a clamped to [0, 4], those of the colour as
// T(e max(H, 0) / (a + 0.02)) or, where it is not demodulated, T(e max(H, 0)), as is light without albedo, all but the
// albedo clamped to +-65504.
// in: [H, W, c], out: [Hp, Wp, c] slices. One pixel an invocation, a vec4 at a time.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/transfer.glsl"
#include "shaders/pack_auxiliary/pack_auxiliary.h"
layout(constant_id = 0) const int kChannels = 4;
layout(constant_id = 1) const int kAlbedoOffset = -1;
layout(constant_id = 2) const int kColourOffset = -1;
layout(constant_id = 3) const bool kDemodulates = false;
layout(constant_id = 4) const uint kTransfer = 0;
layout(constant_id = 5) const uint kLightChannels = 0;  // bit c: channel c
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1) uniform samplerBuffer exposure;
#define PARAMS PackAuxiliaryParams
#define TARGET_BINDING 2
#define RUN 1
#define LANE_ID 6
#include "shaders/common/image_kernel.glsl"

// The colour as the network sees it.
vec3 colourAt(int texel) {
  vec3 divisor = vec3(1);
  if (kDemodulates) divisor = clamp(fetchThree(source, texel, kAlbedoOffset), 0.0, kAlbedoMax) + kAlbedoEpsilon;
  const vec3 radiance = max(fetchThree(source, texel, kColourOffset), 0.0);
  return encoded(kTransfer, radiance, texelFetch(exposure, p.exposure).x, divisor);
}

// Radiance without albedo as the network sees it.
vec4 encodedLight(vec4 light) {
  const float e = texelFetch(exposure, p.exposure).x;
  return vec4(encoded(kTransfer, light.rgb, e, vec3(1)), encoded(kTransfer, light.aaa, e, vec3(1)).x);
}

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const int from = texelAt(p.source, replicated(at, ivec2(p.source.width, p.source.height)));
  vec3 colour = vec3(0);
  if (kColourOffset >= 0) colour = colourAt(from);
  [[unroll]] for (int q = 0; q < kChannels / 4; q++) {
    vec4 value = texelFetch(source, from + q);
    if (kColourOffset >= 0) {
      [[unroll]] for (int k = 0; k < 4; k++) {
        const int channel = 4 * q + k - kColourOffset;
        if (channel >= 0 && channel < 3) value[k] = colour[channel];
      }
    }
    if ((kLightChannels >> (4 * q) & 15u) != 0) {
      const vec4 light = encodedLight(max(value, 0.0));
      [[unroll]] for (int k = 0; k < 4; k++) {
        if ((kLightChannels >> (4 * q + k) & 1u) != 0) value[k] = light[k];
      }
    }
    vec4 least = vec4(-kAuxiliaryMax), most = vec4(kAuxiliaryMax);
    if (kAlbedoOffset >= 0) {
      const ivec4 channel = 4 * q + ivec4(0, 1, 2, 3) - kAlbedoOffset;
      const bvec4 isAlbedo = equal(clamp(channel, 0, 2), channel);
      least = mix(least, vec4(0), isAlbedo);
      most = mix(most, vec4(kAlbedoMax), isAlbedo);
    }
    storePixel(0, q, clamp(value, least, most));
  }
}
