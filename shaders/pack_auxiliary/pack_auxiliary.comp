// out[y, x] = in[min(y, H - 1), min(x, W - 1)], the albedo's three channels clamped to [0, 4], others to +-65504.
// in: [H, W, c], out: [Hp, Wp, c] slices. One pixel an invocation, a vec4 at a time.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/transfer.h"
#include "shaders/pack_auxiliary/pack_auxiliary.h"
layout(constant_id = 0) const int kChannels = 4;
layout(constant_id = 1) const int kAlbedoOffset = -1;
layout(binding = 0) uniform samplerBuffer source;
#define PARAMS PackAuxiliaryParams
#define TARGET_BINDING 1
#define RUN 1
#define LANE_ID 2
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  const int from = texelAt(p.source, replicated(at, ivec2(p.source.width, p.source.height)));
  [[unroll]] for (int q = 0; q < kChannels / 4; q++) {
    const vec4 value = texelFetch(source, from + q);
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
