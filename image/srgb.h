#pragma once

#include <algorithm>
#include <cmath>

namespace xrds {

/// The sRGB transfer function (IEC 61966-2-1): linear light in [0, 1] to the display value in [0, 1].
inline double srgbFromLinear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

/// What a display shows of radiance, which it cuts off at [0, 1].
inline double displayValue(float radiance) { return srgbFromLinear(std::clamp(double{radiance}, 0.0, 1.0)); }

/// The inverse of srgbFromLinear(): display value in [0, 1] to linear light in [0, 1].
inline double linearFromSrgb(double display) {
  return display <= 0.04045 ? display / 12.92 : std::pow((display + 0.055) / 1.055, 2.4);
}

}  // namespace xrds
