// e = 0.18 / exp(mean(log L)) over the bins with L > 1e-8, the mean luminance of bin (i, j), whose pixels are those of rows
// i h / rows to (i + 1) h / rows and columns alike; 1 if there are none. colour: [h, w, 4]; target: (e, 1 / e, count, 0).
// One workgroup; each of its kGroup invocations sums every kGroup-th bin, then a tree: the order never changes. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/storage.glsl"
#include "shaders/binned_exposure/binned_exposure.h"
layout(local_size_x_id = 0) in;
// The size of an array has a constant of its own: Metal's cannot come from gl_WorkGroupSize before SPIRV-Cross of August 2025.
layout(constant_id = 1) const uint kGroup = 1;  // invocations of the workgroup
layout(binding = 0) uniform samplerBuffer colour;
layout(binding = 1, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { BinnedExposureParams p; };

const float kKey = 0.18;
shared vec2 partial[kGroup];  // sum of logarithms, count

// All lanes go through all pixels of a whole bin: lavapipe of Mesa 26.1 crashes where texels are fetched in a loop that
// lanes leave one by one. What is divided before it is added does not overflow.
float luminanceOf(ivec2 bin) {
  const int top = bin.y * p.height / p.rows, bottom = (bin.y + 1) * p.height / p.rows;
  const int left = bin.x * p.width / p.columns, right = (bin.x + 1) * p.width / p.columns;
  const float share = 1.0 / float((bottom - top) * (right - left));
  float sum = 0;
  for (int dy = 0; dy < kExposureBin; dy++) {
    const int y = min(top + dy, bottom - 1);
    float row = 0;
    for (int dx = 0; dx < kExposureBin; dx++) {
      const int x = min(left + dx, right - 1);
      const vec3 value = texelFetch(colour, int(uint(y * p.width + x) * p.source.stride + p.source.offset)).rgb;
      const vec3 counted = mix(vec3(0), min(value, vec3(kBinBrightest)), greaterThan(value, vec3(0)));
      const float luminance = dot(share * counted, vec3(0.212671, 0.715160, 0.072169));
      row += left + dx < right ? luminance : 0.0;
    }
    sum += top + dy < bottom ? row : 0.0;
  }
  return min(sum, kBinBrightest);
}

void main() {
  const uint lane = gl_LocalInvocationIndex, count = uint(p.rows * p.columns);
  vec2 total = vec2(0);
  for (uint first = 0; first < count; first += kGroup) {
    const uint bin = min(first + lane, count - 1);
    const float luminance = luminanceOf(ivec2(bin % uint(p.columns), bin / uint(p.columns)));
    if (first + lane < count && luminance > kBinDarkest) total += vec2(log(luminance), 1);
  }
  partial[lane] = total;
  for (uint width = kGroup / 2; width > 0; width /= 2) {
    barrier();
    if (lane < width) partial[lane] += partial[lane + width];
  }
  if (lane != 0) return;
  const float exposure = partial[0].y > 0.0 ? kKey / exp(partial[0].x / partial[0].y) : 1.0;
  target[p.target] = stored4(vec4(exposure, 1.0 / exposure, partial[0].y, 0));
}
