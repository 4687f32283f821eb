// out[y, x, n] = sum of in[(y + 1 - i) / 2, (x + 1 - j) / 2, 16 n + 4 i + j] over rows i and columns j of the patches, where
// both divide and lie in the image: two rows by two columns. in: [h, w, 16 N], a row of a patch a texel; out: [2h, 2w, N
// rounded up to four]. One output pixel an invocation, fp32 sums.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/fold/fold.h"
layout(constant_id = 0) const int kChannels = 3;  // N
layout(binding = 0) uniform samplerBuffer source;
#define PARAMS FoldParams
#define TARGET_BINDING 1
#define RUN 1
#define LANE_ID 1
#include "shaders/common/image_kernel.glsl"

void main() {
  const ivec2 at = firstPixel();
  if (isOutside(at)) return;
  // The pixel that `at` is of, whose patch has it in its middle, and the neighbour whose patch has it at its rim.
  const ivec2 odd = at & 1, own = at >> 1, size = ivec2(p.source.width, p.source.height);
  const ivec2 other = own + 2 * odd - 1, inside = clamp(other, ivec2(0), size - 1);
  const bvec2 hasOther = equal(other, inside);
  const int ownRow = odd.y + 1, otherRow = 3 - 3 * odd.y;
  const bool isOdd = odd.x == 1;
  const int ownAt = texelAt(p.source, own), besideAt = texelAt(p.source, ivec2(inside.x, own.y));
  const int aboveAt = texelAt(p.source, ivec2(own.x, inside.y)), cornerAt = texelAt(p.source, inside);
  [[unroll]] for (int first = 0; first < kChannels; first += 4) {
    vec4 sums = vec4(0);
    [[unroll]] for (int n = 0; n < 4; n++) {
      if (first + n < kChannels) {
        const int patch_ = kFoldSide * (first + n);
        const vec4 a = texelFetch(source, ownAt + patch_ + ownRow);
        const vec4 b = texelFetch(source, besideAt + patch_ + ownRow);
        const vec4 c = texelFetch(source, aboveAt + patch_ + otherRow);
        const vec4 d = texelFetch(source, cornerAt + patch_ + otherRow);
        float sum = isOdd ? a.z : a.y;
        sum += hasOther.x ? (isOdd ? b.x : b.w) : 0.0;
        sum += hasOther.y ? (isOdd ? c.z : c.y) : 0.0;
        sum += all(hasOther) ? (isOdd ? d.x : d.w) : 0.0;
        sums[n] = sum;
      }
    }
    storePixel(0, first / 4, sums);
  }
}
