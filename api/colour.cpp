#include "api/colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "xrds/error.h"

namespace xrds {
namespace {

using Radiance = std::array<double, 3>;

constexpr uint32_t kParts = 4;   // of the frame, to a side
constexpr uint32_t kAround = 3;  // pixels to a side whose noise is told together
constexpr double kLevelFloor = 0.01, kMostLevelRatio = 8;

uint32_t scaleOf(const PixelView& low, const PixelView& full) {
  const uint32_t scale = low.width ? full.width / low.width : 0;
  if (scale == 0 || full.width != scale * low.width || full.height != scale * low.height)
    throw InvalidArgument("A colour of " + std::to_string(full.width) + " x " + std::to_string(full.height) +
                          " pixels cannot be merged with one of " + std::to_string(low.width) + " x " +
                          std::to_string(low.height) + ": expected a whole multiple.");
  return scale;
}

enum class Pixels : uint8_t { all, black, white };  // of a chequerboard

// The mean of a square of the full-resolution colour, or of every second pixel of it.
Radiance squareMean(const PixelView& full, uint32_t scale, uint32_t x, uint32_t y, Pixels pixels) {
  Radiance mean{};
  uint32_t count = 0;
  for (uint32_t i = 0; i < scale; ++i)
    for (uint32_t j = 0; j < scale; ++j) {
      if (pixels != Pixels::all && ((i + j) % 2 == 0) != (pixels == Pixels::black)) continue;
      const float* pixel = full.pixels + (size_t{scale * y + i} * full.width + scale * x + j) * full.stride;
      for (uint32_t c = 0; c < 3; ++c) mean[c] += std::max(pixel[c], 0.F);
      ++count;
    }
  for (double& channel : mean) channel /= count;
  return mean;
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

/// The mean of the middle half of the values, in order of size.
double middleMean(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto quarter = static_cast<ptrdiff_t>(values.size() / 4);
  const auto first = values.begin() + quarter, last = values.end() - quarter;
  std::nth_element(values.begin(), first, values.end());
  std::nth_element(first, last, values.end());
  return std::accumulate(first, last, 0.0) / static_cast<double>(last - first);
}

/// Of a low-resolution pixel, or the sums of some: radiance of both images, squares of half the difference of the two
/// halves of the full-resolution pixels, and of the difference of the two images.
struct PixelNoise {
  double level = 0, halves = 0, both = 0;
  uint32_t count = 0;

  void add(const PixelNoise& other) {
    level += other.level;
    halves += other.halves;
    both += other.both;
    count += other.count;
  }
};

PixelNoise noiseOf(const PixelView& low, const PixelView& full, uint32_t scale, uint32_t x, uint32_t y) {
  const Radiance black = squareMean(full, scale, x, y, Pixels::black),
                 white = squareMean(full, scale, x, y, Pixels::white);
  const float* pixel = pixelOf(low, x, y);
  PixelNoise noise{.count = 1};
  for (uint32_t c = 0; c < 3; ++c) {
    const double mean = (black[c] + white[c]) / 2;
    noise.level += mean + pixel[c];
    noise.halves += square((black[c] - white[c]) / 2);
    noise.both += square(pixel[c] - mean);
  }
  return noise;
}

}  // namespace

double shareByNoise(const PixelView& low, const PixelView& full) {
  const uint32_t scale = scaleOf(low, full);
  if (scale < 2)
    throw InvalidArgument("The noise of a colour of full resolution cannot be told from that of the other render.");
  std::vector<PixelNoise> pixels;
  pixels.reserve(size_t{low.width} * low.height);
  for (uint32_t y = 0; y < low.height; ++y)
    for (uint32_t x = 0; x < low.width; ++x) pixels.push_back(noiseOf(low, full, scale, x, y));

  // Of few samples most pixels of a dark scene are black: those around tell how much noise there is.
  const uint32_t columns = std::min(kAround, low.width), rows = std::min(kAround, low.height);
  std::vector<double> ofMeans, ofBoth;
  for (uint32_t y = 0; y + rows <= low.height; ++y)
    for (uint32_t x = 0; x + columns <= low.width; ++x) {
      PixelNoise around;
      for (uint32_t i = 0; i < rows * columns; ++i)
        around.add(pixels[size_t{y + i / columns} * low.width + x + i % columns]);
      if (!(around.level > 0)) continue;
      const double relative = around.count / square(around.level);
      ofMeans.push_back(relative * around.halves);
      ofBoth.push_back(relative * around.both);
    }
  const double means = middleMean(ofMeans), both = std::max(middleMean(ofBoth), means);
  constexpr double kLeastShare = 1e-3;
  return both > 0 ? std::clamp((both - means) / both, kLeastShare, 1 - kLeastShare) : 0.5;
}

double differenceOf(const PixelView& low, const PixelView& full) {
  const uint32_t scale = scaleOf(low, full);
  std::array<std::array<double, 2>, size_t{kParts} * kParts> sums{};
  for (uint32_t y = 0; y < low.height; ++y)
    for (uint32_t x = 0; x < low.width; ++x) {
      const Radiance square = squareMean(full, scale, x, y, Pixels::all);
      const float* pixel = pixelOf(low, x, y);
      const double sum = double{pixel[0]} + pixel[1] + pixel[2];
      auto& part = sums[size_t{kParts * y / low.height} * kParts + kParts * x / low.width];
      part[0] += std::max(sum, 0.0);
      part[1] += square[0] + square[1] + square[2];
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
      const Radiance square = squareMean(full, scale, x, y, Pixels::all);
      for (uint32_t c = 0; c < 3; ++c)
        merged.push_back(static_cast<float>((1 - share) * pixelOf(low, x, y)[c] + share * square[c]));
    }
  return merged;
}

std::vector<float> atLevelOf(const PixelView& full, const PixelView& merged) {
  const uint32_t scale = scaleOf(merged, full);
  const auto radiance = [](float value) { return std::max(value, 0.F); };
  double floor = 0;
  for (uint32_t y = 0; y < merged.height; ++y)
    for (uint32_t x = 0; x < merged.width; ++x)
      for (uint32_t c = 0; c < 3; ++c) floor += radiance(pixelOf(merged, x, y)[c]);
  floor *= kLevelFloor / (3.0 * merged.width * merged.height);

  std::vector<float> levelled(size_t{3} * full.width * full.height);
  const auto levelSquare = [&](uint32_t x, uint32_t y, uint32_t c) {
    double mean = 0;
    for (uint32_t i = 0; i < scale * scale; ++i)
      mean += radiance(pixelOf(full, scale * x + i % scale, scale * y + i / scale)[c]);
    mean /= scale * scale;
    const double level = radiance(pixelOf(merged, x, y)[c]) + floor;
    const double ratio = mean + floor > 0 ? std::min(level / (mean + floor), kMostLevelRatio) : 1;
    for (uint32_t i = 0; i < scale * scale; ++i) {
      const uint32_t column = scale * x + i % scale, row = scale * y + i / scale;
      levelled[3 * (size_t{row} * full.width + column) + c] =
          static_cast<float>(ratio * radiance(pixelOf(full, column, row)[c]));
    }
  };
  for (uint32_t y = 0; y < merged.height; ++y)
    for (uint32_t x = 0; x < merged.width; ++x)
      for (uint32_t c = 0; c < 3; ++c) levelSquare(x, y, c);
  return levelled;
}

}  // namespace xrds
