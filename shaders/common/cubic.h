#pragma once

#include <cmath>

namespace xrds {

/// Keys' cubic convolution kernel at that distance; its slope at distance 1 is a. -0.5 is Catmull and Rom's.
inline double cubicWeight(double distance, double a) {
  const double t = std::abs(distance);
  if (t < 1) return ((a + 2) * t - (a + 3)) * t * t + 1;
  return t < 2 ? a * (((t - 5) * t + 8) * t - 4) : 0;
}

}  // namespace xrds
