#ifndef XRDS_SHADERS_EXPOSURE_H
#define XRDS_SHADERS_EXPOSURE_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
struct ExposureParams {
  Slice source;
  uint pixelCount;
  uint target;  // vec4 index of the result
};

const uint kExposureAtOnce = 4;  // pixels of an invocation, which fetches the next before it has the last
const float kExposureKey = 0.18f;
const float kExposureDarkest = 1e-8f;      // over the power mean: darker pixels do not count
const float kExposureMin = 1e-37f;         // of which the reciprocal is a float too; also of luminances
const float kExposureBrightest = 3.4e38f;  // of luminances: the sum of the channels is a float
XRDS_SHARED_END

#ifdef __cplusplus
#include <algorithm>
#include <cmath>

#include "shaders/common/operator_facts.h"
namespace xrds {

/// The automatic exposure of an image: e = 0.18 over the geometric mean of its Rec. 709 luminances L, at least 1e-37; 1
/// if the image is black. Negative channels count as 0. Pixels count that are below 3.4e38 and brighter than 1e-8 of
/// the power mean (mean of L^(1/8))^8 of all from 1e-37 to 3.4e38: nearly black ones do not, however bright the image
/// is, and fireflies hardly move it. So the exposure of k times the image is e / k.
struct Exposure {
  TensorView colour;  // [h, w, 4] linear radiance
  TensorView output;  // [1, 1, 4] f32: e, 1 / e, the number of pixels that count, 0
};

/// [1, 1, 4].
TensorShape outputShape(const Exposure& op);

/// One workgroup, so that the sum has one order. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const Exposure& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const Exposure& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const Exposure& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const Exposure& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const Exposure& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<Exposure>& examples);

/// Rec. 709, of a pixel whose negative channels count as 0. NaN of what has one.
inline double luminance(double red, double green, double blue) {
  const auto light = [](double channel) { return channel < 0 ? 0 : channel; };
  return 0.2126 * light(red) + 0.7152 * light(green) + 0.0722 * light(blue);
}

/// The exposure of pixelCount pixels in double precision, where luminanceOf(i) is the luminance of pixel i.
struct ExposureResult {
  double exposure = 1;
  uint64_t count = 0;  // pixels that count
};
template <class LuminanceOf>
ExposureResult automaticExposure(uint64_t pixelCount, const LuminanceOf& luminanceOf) {
  double roots = 0, logarithms = 0;
  uint64_t lit = 0, count = 0;
  const auto isAbove = [](double luminance, double bound) {
    return luminance > bound && luminance < double{shader::kExposureBrightest};
  };
  for (uint64_t i = 0; i < pixelCount; ++i) {
    const double luminance = luminanceOf(i);
    if (!isAbove(luminance, shader::kExposureMin)) continue;
    roots += std::pow(luminance, 0.125);
    ++lit;
  }
  if (lit == 0) return {};
  const double darkest = shader::kExposureDarkest * std::pow(roots / static_cast<double>(lit), 8);
  for (uint64_t i = 0; i < pixelCount; ++i) {
    const double luminance = luminanceOf(i);
    if (!isAbove(luminance, std::max(darkest, double{shader::kExposureMin}))) continue;
    logarithms += std::log(luminance);
    ++count;
  }
  const double exposure = 0.18 / std::exp(logarithms / static_cast<double>(count));
  return {std::max(exposure, double{shader::kExposureMin}), count};
}

}  // namespace xrds
#endif
#endif
