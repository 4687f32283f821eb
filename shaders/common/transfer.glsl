// The radiance transform and its inverse on three channels; `transfer` is a specialization constant. GLSL has neither
// log1p nor expm1, and its log is exact only to 2^-21 near 1, so small arguments go through a series: the relative
// error stays at about 1e-6 from the smallest number to the largest.
#ifndef XRDS_SHADERS_COMMON_TRANSFER_GLSL
#define XRDS_SHADERS_COMMON_TRANSFER_GLSL
#include "shaders/common/transfer.h"

// log(1 + x) for x >= 0. Below 1: 2 atanh(x / (2 + x)), whose argument is at most 1/3.
vec3 log1p(vec3 x) {
  const vec3 z = x / (2.0 + x);
  const vec3 s = z * z;
  const vec3 series =
      1.0 + s * (1.0 / 3.0 + s * (0.2 + s * (1.0 / 7.0 + s * (1.0 / 9.0 + s * (1.0 / 11.0 + s * (1.0 / 13.0))))));
  return mix(log(1.0 + x), 2.0 * z * series, lessThan(x, vec3(1)));
}

// exp(x) - 1. Within a half of 0: eight terms of the series.
vec3 expm1(vec3 x) {
  const vec3 tail = 1.0 + x / 5.0 * (1.0 + x / 6.0 * (1.0 + x / 7.0 * (1.0 + x / 8.0)));
  const vec3 series = x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0 * tail)));
  return mix(exp(x) - 1.0, series, lessThan(abs(x), vec3(0.5)));
}

// T(radiance exposure / divisor), where the product may be too large for a float.
vec3 encoded(uint transfer, vec3 radiance, float exposure, vec3 divisor) {
  const vec3 product = radiance * exposure / divisor;
  if (transfer != kTransferLog1p) return clamp(product, -kLinearMax, kLinearMax);
  return mix(log1p(max(product, 0.0)), log(radiance) + log(exposure) - log(divisor),
             greaterThan(product, vec3(kLogarithmsFrom)));
}

// T^-1(x) factor / exposure, where T^-1(x) alone may be too large for a float. The result never is.
vec3 decoded(uint transfer, vec3 x, vec3 factor, vec2 exposureAndInverse) {
  vec3 product = x * factor * exposureAndInverse.y;
  if (transfer == kTransferLog1p)
    product = mix(expm1(x) * factor * exposureAndInverse.y, exp(x + log(factor) - log(exposureAndInverse.x)),
                  greaterThan(x, vec3(log(kLogarithmsFrom) / 2)));
  return clamp(product, -kRadianceMax, kRadianceMax);
}

#endif
