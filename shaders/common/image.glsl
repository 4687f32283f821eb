// Addresses of pixels, edge replication, and three channels that may straddle two texels.
#ifndef XRDS_SHADERS_COMMON_IMAGE_GLSL
#define XRDS_SHADERS_COMMON_IMAGE_GLSL
#include "shaders/common/image.h"

int texelAt(Image image, ivec2 position) {
  return (position.y * image.width + position.x) * image.stride + image.offset;
}

// Clamped to +- limit; NaN counts as the least. Comparisons: cheaper than clamp() on CPU devices.
float bounded(float logit, float limit) {
  const float raised = logit > -limit ? logit : -limit;
  return raised < limit ? raised : limit;
}

// A learned logit of a kernel, and of a share.
float boundedLogit(float logit) { return bounded(logit, kLogitMax); }
float boundedShare(float logit) { return bounded(logit, kShareLogitMax); }

// The pixel of an image of that size nearest to the position.
ivec2 replicated(ivec2 position, ivec2 size) { return clamp(position, ivec2(0), size - 1); }

// The pixel that a position at or behind the image's begin mirrors, once or back and forth: 0 1 2 1 0 1 of size 3.
ivec2 reflected(ivec2 position, ivec2 size) {
  const ivec2 last = max(size - 1, ivec2(1)), inPeriod = position % (2 * last);
  return min(min(inPeriod, 2 * last - inPeriod), size - 1);
}

// Channels first .. first + 2 of the pixel that starts at the texel; `first` is a specialization constant.
vec3 fetchThree(samplerBuffer source, int texel, int first) {
  const vec4 a = texelFetch(source, texel + first / 4);
  if (first % 4 == 0) return a.xyz;
  if (first % 4 == 1) return a.yzw;
  const vec4 b = texelFetch(source, texel + first / 4 + 1);
  return first % 4 == 2 ? vec3(a.zw, b.x) : vec3(a.w, b.xy);
}

#endif
