#include "api/colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "xrds/error.h"

namespace xrds {
namespace {

using Radiance = std::array<double, 3>;

constexpr uint32_t kParts = 4;  // of the frame, to a side
constexpr double kLevelFloor = 0.01, kMostLevelRatio = 8;

uint32_t scaleOf(const PixelView& low, const PixelView& full) {
  const uint32_t scale = low.width ? full.width / low.width : 0;
  if (scale == 0 || full.width != scale * low.width || full.height != scale * low.height)
    throw InvalidArgument("A colour of " + std::to_string(full.width) + " x " + std::to_string(full.height) +
                          " pixels cannot be merged with one of " + std::to_string(low.width) + " x " +
                          std::to_string(low.height) + ": expected a whole multiple.");
  return scale;
}

/// Of the pixels of a square of the full-resolution colour, or of every second one of them: the mean of those that are
/// finite, and their number.
struct SquareMean {
  Radiance mean{};
  uint32_t count = 0;
};

enum class Pixels : uint8_t { all, black, white };  // of a chequerboard

SquareMean squareMean(const PixelView& full, uint32_t scale, uint32_t x, uint32_t y, Pixels pixels) {
  SquareMean found;
  for (uint32_t i = 0; i < scale; ++i)
    for (uint32_t j = 0; j < scale; ++j) {
      if (pixels != Pixels::all && ((i + j) % 2 == 0) != (pixels == Pixels::black)) continue;
      const float* pixel = full.pixels + (size_t{scale * y + i} * full.width + scale * x + j) * full.stride;
      if (!std::isfinite(pixel[0]) || !std::isfinite(pixel[1]) || !std::isfinite(pixel[2])) continue;
      for (uint32_t c = 0; c < 3; ++c) found.mean[c] += std::max(pixel[c], 0.F);
      ++found.count;
    }
  for (double& channel : found.mean) channel /= std::max(found.count, 1u);
  return found;
}

const float* pixelOf(const PixelView& image, uint32_t x, uint32_t y) {
  return image.pixels + (size_t{y} * image.width + x) * image.stride;
}

double square(double x) { return x * x; }

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double shareByNoise(const PixelView& low, const PixelView& full) {
  const uint32_t scale = scaleOf(low, full);
  if (scale < 2)
    throw InvalidArgument("The noise of a colour of full resolution cannot be told from that of the other render.");
  std::vector<double> ofMeans, ofBoth;
  for (uint32_t y = 0; y < low.height; ++y)
    for (uint32_t x = 0; x < low.width; ++x) {
      const SquareMean black = squareMean(full, scale, x, y, Pixels::black),
                       white = squareMean(full, scale, x, y, Pixels::white);
      const float* pixel = pixelOf(low, x, y);
      if (black.count == 0 || white.count == 0) continue;
      double level = 0, halves = 0, both = 0;
      for (uint32_t c = 0; c < 3; ++c) {
        const double mean = (black.mean[c] + white.mean[c]) / 2;
        level += mean + pixel[c];
        halves += square((black.mean[c] - white.mean[c]) / 2);
        both += square(pixel[c] - mean);
      }
      if (!(level > 0) || !std::isfinite(both)) continue;
      ofMeans.push_back(halves / square(level));
      ofBoth.push_back(both / square(level));
    }
  const double means = median(ofMeans), both = std::max(median(ofBoth), means);
  constexpr double kLeastShare = 1e-3;
  return both > 0 ? std::clamp((both - means) / both, kLeastShare, 1 - kLeastShare) : 0.5;
}

double differenceOf(const PixelView& low, const PixelView& full) {
  const uint32_t scale = scaleOf(low, full);
  std::array<std::array<double, 2>, size_t{kParts} * kParts> sums{};
  for (uint32_t y = 0; y < low.height; ++y)
    for (uint32_t x = 0; x < low.width; ++x) {
      const SquareMean square = squareMean(full, scale, x, y, Pixels::all);
      const float* pixel = pixelOf(low, x, y);
      const double sum = double{pixel[0]} + pixel[1] + pixel[2];
      if (square.count == 0 || !std::isfinite(sum)) continue;
      auto& part = sums[size_t{kParts * y / low.height} * kParts + kParts * x / low.width];
      part[0] += std::max(sum, 0.0);
      part[1] += square.mean[0] + square.mean[1] + square.mean[2];
    }
  std::vector<double> differences;
  for (const auto& [a, b] : sums)
    if (a + b > 0) differences.push_back(std::abs(a - b) / (a + b));
  return median(differences);
}

std::vector<float> mergedByShare(const PixelView& low, const PixelView& full, double share) {
  const uint32_t scale = scaleOf(low, full);
  std::vector<float> merged;
  merged.reserve(size_t{3} * low.width * low.height);
  for (uint32_t y = 0; y < low.height; ++y)
    for (uint32_t x = 0; x < low.width; ++x) {
      const SquareMean square = squareMean(full, scale, x, y, Pixels::all);
      const double part = square.count > 0 ? share : 0;
      for (uint32_t c = 0; c < 3; ++c)
        merged.push_back(static_cast<float>((1 - part) * pixelOf(low, x, y)[c] + part * square.mean[c]));
    }
  return merged;
}

std::vector<float> atLevelOf(const PixelView& full, const PixelView& merged) {
  const uint32_t scale = scaleOf(merged, full);
  const auto finite = [](float value) { return std::isfinite(value) ? std::max(value, 0.F) : 0.F; };
  double floor = 0;
  for (uint32_t y = 0; y < merged.height; ++y)
    for (uint32_t x = 0; x < merged.width; ++x)
      for (uint32_t c = 0; c < 3; ++c) floor += finite(pixelOf(merged, x, y)[c]);
  floor *= kLevelFloor / (3.0 * merged.width * merged.height);

  std::vector<float> levelled(size_t{3} * full.width * full.height);
  const auto levelSquare = [&](uint32_t x, uint32_t y, uint32_t c) {
    double mean = 0;
    for (uint32_t i = 0; i < scale * scale; ++i)
      mean += finite(pixelOf(full, scale * x + i % scale, scale * y + i / scale)[c]);
    mean /= scale * scale;
    const double level = finite(pixelOf(merged, x, y)[c]) + floor;
    const double ratio = mean + floor > 0 ? std::min(level / (mean + floor), kMostLevelRatio) : 1;
    for (uint32_t i = 0; i < scale * scale; ++i) {
      const uint32_t column = scale * x + i % scale, row = scale * y + i / scale;
      levelled[3 * (size_t{row} * full.width + column) + c] =
          static_cast<float>(ratio * finite(pixelOf(full, column, row)[c]));
    }
  };
  for (uint32_t y = 0; y < merged.height; ++y)
    for (uint32_t x = 0; x < merged.width; ++x)
      for (uint32_t c = 0; c < 3; ++c) levelSquare(x, y, c);
  return levelled;
}

}  // namespace xrds
