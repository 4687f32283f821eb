// Winograd's minimal filtering F(kPixels, 3) along a row: kPixels results side by side of kPixels + 2 inputs and 3 weights
// take kElements products instead of 3 kPixels. Weights come transformed (conv3x3.cpp). F(4, 3) interpolates at 0, 3/2,
// -3/2, 2/3, -2/3 and infinity: a third less rounding than with the customary 0, 1, -1, 2, -2.
#ifdef XRDS_LANE4
const uint kPixels = 4;
#else
const uint kPixels = 2;
#endif
const uint kElements = kPixels + 2;

vec4[kElements] transformed(vec4 d[kElements]) {
#ifdef XRDS_LANE4
  const float a = kWinogradPoint, b = 1 / a;
  const vec4 evenA = d[4] - b * b * d[2], oddA = a * (d[3] - b * b * d[1]);
  const vec4 evenB = d[4] - a * a * d[2], oddB = b * (d[3] - a * a * d[1]);
  return vec4[](d[0] - (a * a + b * b) * d[2] + d[4], evenA + oddA, evenA - oddA, evenB + oddB, evenB - oddB,
                d[1] - (a * a + b * b) * d[3] + d[5]);
#else
  return vec4[](d[0] - d[2], d[1] + d[2], d[2] - d[1], d[1] - d[3]);
#endif
}

// Result h of the products.
vec4 resultOf(vec4 m[kElements], uint h) {
#ifdef XRDS_LANE4
  const float a = kWinogradPoint, b = 1 / a;
  switch (h) {
    case 0: return m[0] + (m[1] + m[2]) + (m[3] + m[4]);
    case 1: return a * (m[1] - m[2]) + b * (m[3] - m[4]);
    case 2: return a * a * (m[1] + m[2]) + b * b * (m[3] + m[4]);
    default: return a * a * a * (m[1] - m[2]) + b * b * b * (m[3] - m[4]) + m[5];
  }
#else
  return h == 0 ? m[0] + m[1] + m[2] : m[1] - m[2] - m[3];
#endif
}
