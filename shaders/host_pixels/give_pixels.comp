// Pixels in any buffer from an image: target[y][x] = source[top + y][left + x], three channels, or these and 1, or all
// four. Two pixels side by side an invocation, so that three halves a pixel make whole words; behind the last one of a
// row the word's other half stays. Halves are rounded to nearest and clamped to +-65504.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/common/half.glsl"
#include "shaders/host_pixels/host_pixels.h"
layout(constant_id = 0) const bool kHalves = false;
layout(constant_id = 1) const bool kMarksLost = false;  // the fourth channel is the source's
layout(local_size_x = kImageGroupWidth, local_size_y = kImageGroupHeight) in;
layout(binding = 0, std430) buffer Target { uint target[]; };
layout(binding = 1, std430) readonly buffer Source { vec4 source[]; };
layout(push_constant) uniform Push { GivePixelsParams p; };

vec4 pixelAt(int x, int y) {
  const vec4 pixel = source[(p.top + y) * p.sourceWidth + p.left + x - p.sourceOrigin];
  return kMarksLost ? pixel : vec4(pixel.rgb, 1);
}

void main() {
  const int x = 2 * int(gl_GlobalInvocationID.x), y = p.rowBegin + int(gl_GlobalInvocationID.y);
  if (x >= p.width || y >= p.rowEnd) return;
  const bool isPair = x + 1 < p.width;
  const vec4 left = pixelAt(x, y), right = pixelAt(isPair ? x + 1 : x, y);
  const uint row = p.firstWord + uint(y - p.rowBegin) * p.rowWords;
  if (!kHalves) {
    const uint first = row + uint(x * p.channels);
    for (int c = 0; c < p.channels; c++) target[first + c] = floatBitsToUint(left[c]);
    for (int c = 0; c < p.channels && isPair; c++) target[first + p.channels + c] = floatBitsToUint(right[c]);
    return;
  }
  const uint first = row + uint(x * p.channels / 2);
  const uvec2 a = packHalf4(left);
  target[first] = a.x;
  if (p.channels == 4) {
    const uvec2 b = packHalf4(right);
    target[first + 1] = a.y;
    if (isPair) target[first + 2] = b.x;
    if (isPair) target[first + 3] = b.y;
  } else if (isPair) {
    const uvec2 b = packHalf4(vec4(left.b, right.rgb));
    target[first + 1] = b.x;
    target[first + 2] = b.y;
  } else {
    target[first + 1] = target[first + 1] & 0xFFFF0000u | a.y & 0xFFFFu;
  }
}
