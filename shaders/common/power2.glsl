// 2^x for x <= 100 by a polynomial, with a relative error of 2e-7: the same bits from every kernel, and on CPU devices a
// third of the instructions of exp2(). 0 below 2^-80, as products with less may be denormal, which makes some CPUs a
// hundred times slower. A comparison, as max() costs four instructions there; this one hands NaN on.
#ifndef XRDS_SHADERS_COMMON_POWER2_GLSL
#define XRDS_SHADERS_COMMON_POWER2_GLSL
const float kLog2E = 1.44269504;

float power2(float x) {
  const bool vanishes = x < -80.0;
  x = vanishes ? 0.0 : x;
  // The last bits of the sum are the exponent of the result. Mesa from 25.0 on makes int() lane by lane.
  const float kRounding = 12582912.0 + 127.0;  // 1.5 * 2^23, and the bias of exponents
  precise const float rounded = x + kRounding, whole = rounded - kRounding;
  const float f = x - whole;
  const float fraction =
      1.0 + f * (0.69314718 + f * (0.24022651 + f * (0.055503324 + f * (0.0096184374 + f * 0.0013398874))));
  return vanishes ? 0.0 : fraction * intBitsToFloat(floatBitsToInt(rounded) << 23);
}

#endif
