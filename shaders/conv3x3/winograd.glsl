// Winograd's minimal filtering F(kPixels, 3) along a row: kPixels results side by side of kPixels + 2 inputs and 3 weights
// take kElements products instead of 3 kPixels. Weights come transformed (conv3x3.cpp).
#include "shaders/common/winograd.glsl"
#ifdef XRDS_LANE4
const uint kPixels = kWinogradSide;
#else
const uint kPixels = 2;
#endif
const uint kElements = kPixels + 2;

vec4[kElements] transformed(vec4 d[kElements]) {
#ifdef XRDS_LANE4
  return winogradInput(d);
#else
  return vec4[](d[0] - d[2], d[1] + d[2], d[2] - d[1], d[1] - d[3]);
#endif
}

// Result h of the products.
vec4 resultOf(vec4 m[kElements], uint h) {
#ifdef XRDS_LANE4
  return winogradResult(m, h);
#else
  return h == 0 ? m[0] + m[1] + m[2] : m[1] - m[2] - m[3];
#endif
}
