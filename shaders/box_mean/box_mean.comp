// out[y, x] = sum over dy, dx < s of in[s y + dy, s x + dx] / s^2.
// in: [s h, s w, c], out: [h, w, c] slices. One output pixel an invocation, a vec4 at a time, fp32 sums.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/box_mean/box_mean.h"
#include "shaders/common/image.glsl"
#include "shaders/common/storage.glsl"
layout(local_size_x = kImageGroupWidth, local_size_y = kImageGroupHeight) in;
layout(constant_id = 0) const int kChannels = 4;
layout(constant_id = 1) const int kScale = 1;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { BoxMeanParams p; };

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, p.rows.begin);
  if (at.x >= p.target.width || at.y >= p.rows.end) return;
  const int from = texelAt(p.source, at * kScale);
  const int to = texelAt(p.target, at) - p.rows.storeOrigin;
  for (int q = 0; q < kChannels / 4; q++) {
    vec4 sum = vec4(0);
    for (int dy = 0; dy < kScale; dy++)
      for (int dx = 0; dx < kScale; dx++)
        sum += texelFetch(source, from + (dy * p.source.width + dx) * p.source.stride + q);
    target[to + q] = stored4(sum * (1.0 / float(kScale * kScale)));
  }
}
