// e = 0.18 / exp(mean(log L)) >= 1e-37 over the pixels with finite Rec. 709 luminance L > 1e-8 M, of which negative
// channels count as 0; 1 if there are none.
// M = (mean(L^(1/8)))^8 over those with finite L > 1e-37. colour: [pixels][4]; target: (e, 1 / e, count, 0). One
// workgroup; each of its kGroup invocations sums every kGroup-th pixel, 64 at a time (long sums of single pixels would lose digits), then a
// tree: the order never changes. fp32.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/common/storage.glsl"
#include "shaders/exposure/exposure.h"
layout(local_size_x_id = 0) in;
// The size of an array has a constant of its own: Metal's cannot come from gl_WorkGroupSize before SPIRV-Cross of August 2025.
layout(constant_id = 1) const uint kGroup = 1;  // invocations of the workgroup
layout(binding = 0) uniform samplerBuffer colour;
layout(binding = 1, std430) writeonly buffer Target { STORED4 target[]; };
layout(push_constant) uniform Push { ExposureParams p; };

shared vec2 partial[kGroup];  // sum of what is asked for, count

// The sum of L^(1/8) or log(L) over the pixels with finite L > darkest, and their number, in partial[0]. The lanes leave
// each loop together: lavapipe of Mesa 26.1 crashes where texels are fetched in one that they leave one by one.
void sumOver(bool roots, float darkest) {
  const uint lane = gl_LocalInvocationIndex;
  vec2 total = vec2(0);
  for (uint begin = 0; begin < p.pixelCount; begin += 64 * kGroup) {
    vec2 sum = vec2(0);
    for (uint first = begin; first < min(begin + 64 * kGroup, p.pixelCount); first += kExposureAtOnce * kGroup) {
      vec3 value[kExposureAtOnce];
      [[unroll]] for (uint i = 0; i < kExposureAtOnce; i++) {
        const uint pixel = min(first + i * kGroup + lane, p.pixelCount - 1);
        const vec3 stored = texelFetch(colour, int(pixel * p.source.stride + p.source.offset)).rgb;
        value[i] = mix(stored, vec3(0), lessThan(stored, vec3(0)));  // NaN stays
      }
      [[unroll]] for (uint i = 0; i < kExposureAtOnce; i++) {
        const float luminance = dot(value[i], vec3(0.2126, 0.7152, 0.0722));
        // The last comparison fails for infinity, both for NaN.
        const bool counts =
            first + i * kGroup + lane < p.pixelCount && luminance > darkest && luminance < kExposureBrightest;
        sum += counts ? vec2(roots ? sqrt(sqrt(sqrt(luminance))) : log(luminance), 1.0) : vec2(0);
      }
    }
    total += sum;
  }
  barrier();
  partial[lane] = total;
  for (uint width = kGroup / 2; width > 0; width /= 2) {
    barrier();
    if (lane < width) partial[lane] += partial[lane + width];
  }
  barrier();
}

void main() {
  sumOver(true, kExposureMin);
  const float root = partial[0].y > 0.0 ? partial[0].x / partial[0].y : 0.0;
  const float square = root * root, fourth = square * square;
  sumOver(false, max(kExposureDarkest * fourth * fourth, kExposureMin));
  if (gl_LocalInvocationIndex != 0) return;
  const float count = partial[0].y;
  const float exposure = count > 0.0 ? max(kExposureKey / exp(partial[0].x / count), kExposureMin) : 1.0;
  target[p.target] = stored4(vec4(exposure, 1.0 / exposure, count, 0));
}
