// The alpha of pixels in any buffer from an image: target[y][x][3] = source[top + y][left + x][0] within [0, 1], what is 0
// or 1 up to rounding as exactly that. One pixel an invocation. Of a half, the word's other half stays.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/half.glsl"
#include "shaders/host_pixels/host_pixels.h"
layout(constant_id = 0) const bool kHalves = false;
layout(local_size_x = kImageGroupWidth, local_size_y = kImageGroupHeight) in;
layout(binding = 0, std430) buffer Target { uint target[]; };
layout(binding = 1, std430) readonly buffer Source { vec4 source[]; };
layout(push_constant) uniform Push { GivePixelsParams p; };

float snappedAlpha(float alpha) {
  if (abs(alpha - 1.0) < kAlphaRounding) return 1.0;
  return abs(alpha) < kAlphaRounding ? 0.0 : clamp(alpha, 0.0, 1.0);
}

void main() {
  const int x = int(gl_GlobalInvocationID.x), y = p.rowBegin + int(gl_GlobalInvocationID.y);
  if (x >= p.width || y >= p.rowEnd) return;
  const float alpha = snappedAlpha(source[(p.top + y) * p.sourceWidth + p.left + x - p.sourceOrigin].r);
  const uint row = p.firstWord + uint(y - p.rowBegin) * p.rowWords;
  if (kHalves) {
    const uint word = row + uint(2 * x + 1);
    target[word] = target[word] & 0xFFFFu | packHalf4(vec4(0, alpha, 0, 0)).x;
  } else {
    target[row + uint(4 * x + 3)] = floatBitsToUint(alpha);
  }
}
