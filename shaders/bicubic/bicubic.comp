// out(p) = sum over 4 x 4 input pixels i around q of k(q_y - i_y) k(q_x - i_x) in(i), q = (p + 0.5) / s - 0.5, k the
// cubic kernel with a = -0.75; i is clamped to the h x w real pixels. in: [>= h, >= w, 4], out: [s h, s w, 4].
// An invocation makes a run of output rows that lie between the same two input rows: 16 loads for kRun pixels. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/bicubic/bicubic.h"
#include "shaders/common/cubic.glsl"
#include "shaders/common/image.glsl"
#include "shaders/common/storage.glsl"
layout(local_size_x = kImageGroupWidth, local_size_y = kImageGroupHeight) in;
layout(constant_id = 0) const int kScale = 1;
layout(constant_id = 1) const int kRun = 1;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { BicubicParams p; };

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.x, p.firstRow + kRun * int(gl_GlobalInvocationID.y));
  if (at.x >= p.target.width || at.y >= p.rows.end) return;
  const ivec2 size = ivec2(p.target.width, p.target.height) / kScale;

  // q + 1 in units of 1 / (2 s): never negative, so that the division rounds down.
  const ivec2 position = 2 * at + 1 + kScale;
  const ivec2 corner = position / (2 * kScale) - 2;
  const vec2 fraction = vec2(position % (2 * kScale)) / float(2 * kScale);

  const vec4 across = cubicWeights(fraction.x, kBicubicParameter);
  vec4 lines[4];
  [[unroll]] for (int i = 0; i < 4; i++) {
    lines[i] = vec4(0);
    [[unroll]] for (int j = 0; j < 4; j++)
      lines[i] += across[j] * texelFetch(source, texelAt(p.source, replicated(corner + ivec2(j, i), size)));
  }
  [[unroll]] for (int r = 0; r < kRun; r++) {
    const vec4 down = cubicWeights(fraction.y + float(r) / float(kScale), kBicubicParameter);
    const vec4 sum = down.x * lines[0] + down.y * lines[1] + down.z * lines[2] + down.w * lines[3];
    const ivec2 to = at + ivec2(0, r);
    if (to.y >= p.rows.begin && to.y < p.rows.end)
      target[texelAt(p.target, to) - p.rows.storeOrigin] = stored4(sum);
  }
}
