// Three channels of an image from pixels in any buffer: target[y][x][channel .. channel + 2] = source[top + y][left + x],
// columns cyclic, then `cleared` zeros. A pixel with a number that is not finite is the mean of the finite ones of the
// nearest square around it that has any. Of an alpha, the last number stands for all three. One pixel an invocation; numbers are floats, or halves two a word.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/host_pixels/host_pixels.h"
layout(constant_id = 0) const bool kHalves = false;
layout(constant_id = 1) const bool kAlpha = false;
layout(local_size_x = kImageGroupWidth, local_size_y = kImageGroupHeight) in;
layout(binding = 0, std430) readonly buffer Source { uint source[]; };
layout(binding = 1, std430) writeonly buffer Target { float target[]; };
layout(push_constant) uniform Push { TakePixelsParams p; };

// Of the row from which on `row` counts the words.
uint bitsAt(uint row, int number) {
  if (!kHalves) return source[row + uint(number)];
  const uint word = source[row + uint(number / 2)];
  return number % 2 == 0 ? word & 0xFFFFu : word >> 16;
}

bool isFinite(uint bits) {
  const uint exponent = kHalves ? 0x7C00u : 0x7F800000u;
  return (bits & exponent) != exponent;
}

// In the fourth component 1 if the pixel is finite, else all are 0.
vec4 finitePixel(int x, int y) {
  const uint row = p.firstWord + uint(y - p.sourceBegin) * p.rowWords;
  vec4 pixel = vec4(0, 0, 0, 1);
  for (int c = 0; c < 3; c++) {
    const uint bits = bitsAt(row, x * p.channels + (kAlpha ? p.channels - 1 : c));
    if (!isFinite(bits)) return vec4(0);
    pixel[c] = kHalves ? unpackHalf2x16(bits).x : uintBitsToFloat(bits);
  }
  return pixel;
}

vec4 repaired(int x, int y) {
  vec4 sum = vec4(0);
  for (int radius = 1; radius <= kMostRepairRadius && sum.w == 0.0; radius++) {
    const ivec2 low = max(ivec2(x, y) - radius, ivec2(0, p.sourceBegin));
    const ivec2 high = min(ivec2(x, y) + radius, ivec2(p.sourceWidth, p.sourceEnd) - 1);
    for (int row = low.y; row <= high.y; row++)
      for (int column = low.x; column <= high.x; column++) sum += finitePixel(column, row);
  }
  return sum / max(sum.w, 1.0);
}

void main() {
  const int x = int(gl_GlobalInvocationID.x), y = p.rowBegin + int(gl_GlobalInvocationID.y);
  if (x >= p.width || y >= p.rowEnd) return;
  const int column = (p.left + x) % p.sourceWidth, row = p.top + y;
  vec4 pixel = finitePixel(column, row);
  if (pixel.w == 0.0) pixel = repaired(column, row);
  const int first = (y * p.width + x) * p.stride + p.channel - p.targetOrigin;
  for (int c = 0; c < 3; c++) target[first + c] = pixel[c];
  for (int c = 0; c < p.cleared; c++) target[first + 3 + c] = 0.0;
}
