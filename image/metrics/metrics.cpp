#include "image/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "image/metrics/flip.h"
#include "image/metrics/image_pair.h"
#include "image/srgb.h"

namespace xrds {
namespace {

// Trimming leaves out one pixel in so many, the worst ones.
constexpr size_t kPixelsPerTrimmedPixel = 1000;

double meanOf(const std::vector<float>& values, size_t count) {
  return std::accumulate(values.begin(), values.begin() + static_cast<ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

void fillRelMse(Metrics& metrics, std::vector<float> values) {
  std::sort(values.begin(), values.end());
  const size_t count = values.size();
  metrics.relMse = meanOf(values, count);
  metrics.relMseTrimmed = meanOf(values, count - count / kPixelsPerTrimmedPixel);
  metrics.relMseMedian = 0.5 * (double{values[(count - 1) / 2]} + double{values[count / 2]});
  metrics.relMsePercentile999 = values[count - 1 - count / kPixelsPerTrimmedPixel];
}

}  // namespace

double psnr(const Image& result, const Image& reference) {
  requireComparable(result, reference);
  double sum = 0.0;
  for (size_t i = 0; i < result.pixels.size(); ++i) {
    const double difference = displayValue(result.pixels[i]) - displayValue(reference.pixels[i]);
    sum += difference * difference;
  }
  const double meanSquaredError = sum / static_cast<double>(result.pixels.size());
  return meanSquaredError == 0.0 ? std::numeric_limits<double>::infinity() : -10.0 * std::log10(meanSquaredError);
}

Image relMseMap(const Image& result, const Image& reference) {
  constexpr double kStabilizer = 0.01;
  requireComparable(result, reference);
  Image map(result.width, result.height, 1);
  const auto channels = static_cast<size_t>(result.channels);
  for (size_t pixel = 0; pixel < map.pixels.size(); ++pixel) {
    double sum = 0.0;
    for (size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
      const double y = reference.pixels[i];
      const double difference = result.pixels[i] - y;
      sum += difference * difference / (y * y + kStabilizer);
    }
    map.pixels[pixel] = static_cast<float>(sum / result.channels);
  }
  return map;
}

Metrics measure(const Image& result, const Image& reference) {
  Metrics metrics;
  metrics.psnr = psnr(result, reference);
  fillRelMse(metrics, relMseMap(result, reference).pixels);
  metrics.flip = flip(result, reference);
  return metrics;
}

std::vector<std::string> metricDefinitions() {
  return {kPsnrDefinition,
          kRelMseDefinition,
          kRelMseTrimmedDefinition,
          kRelMseMedianDefinition,
          kRelMsePercentile999Definition,
          kFlipDefinition};
}

}  // namespace xrds
