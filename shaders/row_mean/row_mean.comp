// out[y, c] = sum over x of in[y, x, c] / w. in: [h, w, c], out: [h, 1, c] slices. Four channels of a row an invocation,
// neighbours side by side in memory; sums of at most 64 pixels are added up, which keeps their digits. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/groups.h"
#include "shaders/common/storage.glsl"
#include "shaders/row_mean/row_mean.h"
layout(local_size_x = kRowMeanGroup) in;
layout(constant_id = 0) const uint kQuads = 1;
layout(binding = 0) uniform samplerBuffer source;
layout(binding = 1, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { RowMeanParams p; };

void main() {
  const uint item = foldedGroup() * kRowMeanGroup + gl_LocalInvocationID.x;
  const uint row = p.rowBegin + item / kQuads, quad = item % kQuads;
  if (row >= p.rowEnd) return;
  const uint from = row * p.width * p.source.stride + p.source.offset + quad;
  vec4 total = vec4(0);
  for (uint begin = 0; begin < p.width; begin += 64) {
    const uint end = min(begin + 64, p.width);
    vec4 sum = vec4(0);
    for (uint x = begin; x < end; x++) sum += texelFetch(source, int(from + x * p.source.stride));
    total += sum;
  }
  target[row * p.target.stride + p.target.offset + quad - p.storeOrigin] = stored4(total / float(p.width));
}
