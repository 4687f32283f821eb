// Winograd's F(4, 3), see winograd.h: a third less rounding than with the customary points 0, 1, -1, 2, -2.
#ifndef XRDS_SHADERS_COMMON_WINOGRAD_GLSL
#define XRDS_SHADERS_COMMON_WINOGRAD_GLSL
#include "shaders/common/winograd.h"

// Four channels of a square of a row. The lanes of a subgroup take them one after the other, channels first, as they lie in
// memory: a cache line that one lane begins the next ones finish.
struct SquareQuad {
  uint square, quad;
};

// The item'th of a row of at most kMostRowItems. By floats, which are exact so far: integers would be divided lane by lane.
SquareQuad squareQuad(uint item, uint quads) {
  const uint square = uint((float(item) + 0.5) / float(quads));
  return SquareQuad(square, item - square * quads);
}

vec4[6] winogradInput(vec4 d[6]) {
  const float a = kWinogradPoint, b = 1 / a;
  const vec4 evenA = d[4] - b * b * d[2], oddA = a * (d[3] - b * b * d[1]);
  const vec4 evenB = d[4] - a * a * d[2], oddB = b * (d[3] - a * a * d[1]);
  return vec4[](d[0] - (a * a + b * b) * d[2] + d[4], evenA + oddA, evenA - oddA, evenB + oddB, evenB - oddB,
                d[1] - (a * a + b * b) * d[3] + d[5]);
}

// Result h of the products.
vec4 winogradResult(vec4 m[6], uint h) {
  const float a = kWinogradPoint, b = 1 / a;
  switch (h) {
    case 0: return m[0] + (m[1] + m[2]) + (m[3] + m[4]);
    case 1: return a * (m[1] - m[2]) + b * (m[3] - m[4]);
    case 2: return a * a * (m[1] + m[2]) + b * b * (m[3] + m[4]);
    default: return a * a * a * (m[1] - m[2]) + b * b * b * (m[3] - m[4]) + m[5];
  }
}

#endif
