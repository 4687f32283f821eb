#ifndef XRDS_SHADERS_BINNED_EXPOSURE_H
#define XRDS_SHADERS_BINNED_EXPOSURE_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
struct BinnedExposureParams {
  Slice source;
  int height, width;
  int rows, columns;  // of bins
  uint target;        // vec4 index of the result
};

const int kExposureBin = 16;                    // pixels to a side of a bin, or some fewer
const uint kBinnedExposureGroup = 256;          // invocations, or as many as the device takes
const float kBinDarkest = 1e-8f;                // luminances of bins: darker ones do not count
const float kBinBrightest = 3.4028234663e+38f;  // of what a pixel counts as
XRDS_SHARED_END

#ifdef __cplusplus
#include <algorithm>
#include <cmath>

#include "shaders/common/operator_facts.h"
namespace xrds {

/// The automatic exposure of denoisers (Open Image Denoise's autoexposure): e = 0.18 over the geometric mean of the
/// luminances of bins of about 16 x 16 pixels, each the mean of its pixels', those at most 1e-8 left out; 1 if there is
/// none. Numbers that are negative or NaN count as 0.
struct BinnedExposure {
  TensorView colour;  // [h, w, 4] linear radiance
  TensorView output;  // [1, 1, 4] f32: e, 1 / e, the number of bins that count, 0
};

/// [1, 1, 4].
TensorShape outputShape(const BinnedExposure& op);

/// One workgroup, so that the sum has one order. Throws std::logic_error on misuse. Pure.
Dispatch dispatch(const BinnedExposure& op, const DeviceTraits& device);

/// None.
std::vector<float> packedWeights(const BinnedExposure& op, const DeviceTraits& device);

/// Double precision, in the order of the formula.
void reference(const BinnedExposure& op, HostMemory& memory);

/// What the rest of the house asks of it.
OperatorFacts facts(const BinnedExposure& op);

/// Carries the moments of what it reads to what it writes.
void propagate(const BinnedExposure& op, Moments& moments);

/// On which a device is examined; none where it does not make this operator.
void addExamples(ExampleMaker& maker, std::vector<BinnedExposure>& examples);

/// The exposure in double precision, where channelAt(y, x, c) is a number of a pixel.
struct BinnedExposureResult {
  double exposure = 1;
  uint64_t count = 0;  // bins that count
};
template <class ChannelAt>
BinnedExposureResult binnedExposureOf(uint32_t height, uint32_t width, const ChannelAt& channelAt) {
  const uint64_t rows = ceilDivide(height, uint32_t{shader::kExposureBin}),
                 columns = ceilDivide(width, uint32_t{shader::kExposureBin});
  const auto inside = [](double value) { return value > 0 ? std::min<double>(value, shader::kBinBrightest) : 0.0; };
  double logarithms = 0;
  uint64_t count = 0;
  for (uint64_t i = 0; i < rows; ++i)
    for (uint64_t j = 0; j < columns; ++j) {
      const auto top = static_cast<uint32_t>(i * height / rows),
                 bottom = static_cast<uint32_t>((i + 1) * height / rows);
      const auto left = static_cast<uint32_t>(j * width / columns),
                 right = static_cast<uint32_t>((j + 1) * width / columns);
      double sum = 0;
      for (uint32_t y = top; y < bottom; ++y)
        for (uint32_t x = left; x < right; ++x)
          sum += 0.212671 * inside(channelAt(y, x, 0)) + 0.715160 * inside(channelAt(y, x, 1)) +
                 0.072169 * inside(channelAt(y, x, 2));
      const double luminance = sum / (double{1} * (bottom - top) * (right - left));
      if (luminance <= double{shader::kBinDarkest}) continue;
      logarithms += std::log(luminance);
      ++count;
    }
  if (count == 0) return {};
  return {0.18 / std::exp(logarithms / static_cast<double>(count)), count};
}

}  // namespace xrds
#endif
#endif
