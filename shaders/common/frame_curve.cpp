#include "shaders/common/frame_curve.h"

#include <algorithm>

namespace xrds {

using namespace shader;

double curved(FrameCurve curve, double value) {
  const double y = std::isnan(value) ? 0 : value;
  if (curve == FrameCurve::normal) return std::clamp(y, -1.0, 1.0) / 2 + 0.5;
  if (curve == FrameCurve::ldr) {
    const double inside = std::clamp(y, 0.0, 1.0);
    return inside <= 0.0031308 ? 12.92 * inside : 1.055 * std::pow(inside, 1 / 2.4) - 0.055;
  }
  const double light = std::clamp(y, 0.0, double{kFrameMax});
  double x = kPuE * std::log(light + kPuF) + kPuG;
  if (light <= kPuY1) x = kPuB * std::pow(light, double{kPuC}) + kPuD;
  if (light <= kPuY0) x = kPuA * light;
  return x / kPuMost;
}

double uncurved(FrameCurve curve, double seen) {
  const double x = std::clamp(seen, 0.0, double{kFrameMax});
  if (curve == FrameCurve::normal) return std::min(2 * x - 1, 1.0);
  if (curve == FrameCurve::ldr) return std::min(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4), 1.0);
  const double pu = x * kPuMost;
  if (pu <= kPuX0) return pu / kPuA;
  if (pu <= kPuX1) return std::pow((pu - kPuD) / kPuB, 1 / double{kPuC});
  return std::exp((pu - kPuG) / kPuE) - kPuF;
}

}  // namespace xrds
