// out[y, x] = in[min(y, H - 1), min(x, W - 1)], the albedo's three channels clamped to [0, 4].
// in: [H, W, c], out: [Hp, Wp, c] slices. One pixel an invocation, a vec4 at a time.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/image.glsl"
#include "shaders/common/storage.glsl"
#include "shaders/common/transfer.h"
#include "shaders/pack_auxiliary/pack_auxiliary.h"
layout(local_size_x = kImageGroupWidth, local_size_y = kImageGroupHeight) in;
layout(constant_id = 0) const int kChannels = 4;
layout(constant_id = 1) const int kAlbedoOffset = -1;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { PackAuxiliaryParams p; };

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, p.rows.begin);
  if (at.x >= p.target.width || at.y >= p.rows.end) return;
  const int from = texelAt(p.source, replicated(at, ivec2(p.source.width, p.source.height)));
  const int to = texelAt(p.target, at) - p.rows.storeOrigin;
  for (int q = 0; q < kChannels / 4; q++) {
    vec4 value = texelFetch(source, from + q);
    if (kAlbedoOffset >= 0) {
      const ivec4 channel = 4 * q + ivec4(0, 1, 2, 3) - kAlbedoOffset;
      const bvec4 isAlbedo = equal(clamp(channel, 0, 2), channel);
      value = mix(value, clamp(value, 0.0, kAlbedoMax), isAlbedo);
    }
    target[to + q] = stored4(value);
  }
}
