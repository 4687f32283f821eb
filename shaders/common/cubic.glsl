// Keys' cubic convolution kernel at the distances t + 1, t, 1 - t and 2 - t, for 0 <= t < 1. Its slope at distance 1 is a:
// -0.5 is Catmull and Rom's. shaders/common/cubic.h has it for C++.
#ifndef XRDS_SHADERS_COMMON_CUBIC_GLSL
#define XRDS_SHADERS_COMMON_CUBIC_GLSL

vec4 cubicWeights(float t, const float a) {
  const vec2 near = vec2(t, 1.0 - t);
  const vec2 far = near + 1.0;
  const vec2 inner = ((a + 2.0) * near - (a + 3.0)) * near * near + 1.0;
  const vec2 outer = ((a * far - 5.0 * a) * far + 8.0 * a) * far - 4.0 * a;
  return vec4(outer.x, inner, outer.y);
}

#endif
