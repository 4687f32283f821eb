#include "image/aux_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace xrds {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string percent(double share) { return number(100.0 * share) + " %"; }

std::string sentence(const NamedLayer& layer, const std::string& finding, const LayerStatistics& statistics) {
  return "The layer '" + layer.name + "' " + finding + " (" + toString(statistics) + ").";
}

std::vector<std::string> checkEmptiness(const NamedLayer& layer, const LayerStatistics& statistics) {
  if (statistics.minimum == 0.0 && statistics.maximum == 0.0) {
    return {sentence(layer, "holds nothing but zeros: check that the renderer writes it", statistics)};
  }
  if (statistics.minimum == statistics.maximum) {
    return {sentence(layer, "has one value everywhere: check that it is the right layer", statistics)};
  }
  return {};
}

// A pixel that is half background has half a normal.
bool showsSurface(const Image& normal, size_t pixel) {
  constexpr double kHalf = 0.5;
  const float* n = &normal.pixels[pixel * 3];
  return std::sqrt(double{n[0]} * n[0] + double{n[1]} * n[1] + double{n[2]} * n[2]) >= kHalf;
}

// Of the pixels that show a surface, all of them without normals.
double shareOfPixelsAbove(const Image& image, float limit, const Image* normal) {
  size_t count = 0;
  size_t considered = 0;
  const auto channels = static_cast<size_t>(image.channels);
  for (size_t pixel = 0; pixel < image.pixelCount(); ++pixel) {
    if (normal != nullptr && !showsSurface(*normal, pixel)) {
      continue;
    }
    const float* values = &image.pixels[pixel * channels];
    ++considered;
    count += *std::max_element(values, values + channels) > limit ? 1 : 0;
  }
  return static_cast<double>(count) / static_cast<double>(std::max<size_t>(considered, 1));
}

}  // namespace

LayerStatistics statisticsOf(const Image& image) {
  LayerStatistics result;
  double minimum = std::numeric_limits<double>::infinity();
  double maximum = -minimum;
  double sum = 0.0;
  size_t zeroPixels = 0;
  const auto channels = static_cast<size_t>(image.channels);
  for (size_t first = 0; first < image.pixels.size(); first += channels) {
    bool isZero = true;
    for (size_t i = first; i < first + channels; ++i) {
      const double value = image.pixels[i];
      isZero = isZero && value == 0.0;
      if (!std::isfinite(value)) {
        ++result.nonFiniteCount;
        continue;
      }
      minimum = std::min(minimum, value);
      maximum = std::max(maximum, value);
      sum += value;
    }
    zeroPixels += isZero ? 1 : 0;
  }
  const size_t finiteCount = image.pixels.size() - result.nonFiniteCount;
  if (finiteCount > 0) {
    result.minimum = minimum;
    result.maximum = maximum;
    result.mean = sum / static_cast<double>(finiteCount);
    result.zeroPixelShare = static_cast<double>(zeroPixels) / static_cast<double>(image.pixelCount());
  }
  return result;
}

std::string toString(const LayerStatistics& statistics) {
  std::string text = "minimum " + number(statistics.minimum) + ", maximum " + number(statistics.maximum) + ", mean " +
                     number(statistics.mean) + ", " + percent(statistics.zeroPixelShare) + " of the pixels black";
  if (statistics.nonFiniteCount > 0) {
    text += ", " + std::to_string(statistics.nonFiniteCount) + " values not finite";
  }
  return text;
}

std::vector<std::string> checkAlbedo(const NamedLayer& albedo, const Image* normal) {
  constexpr float kAboveOne = 1.001F;
  constexpr double kShareOfConcern = 0.02;  // lamps have their radiance, too
  const LayerStatistics statistics = statisticsOf(*albedo.image);
  std::vector<std::string> warnings = checkEmptiness(albedo, statistics);
  if (statistics.minimum < 0.0) {
    warnings.push_back(sentence(albedo, "has negative albedo: check that it is the right layer", statistics));
  }
  const double share = shareOfPixelsAbove(*albedo.image, kAboveOne, normal);
  if (share > kShareOfConcern) {
    warnings.push_back(sentence(albedo,
                                "is above 1 in " + percent(share) +
                                    (normal == nullptr ? " of the pixels" : " of the pixels with a surface") +
                                    ", while albedo lies in [0, 1]: check that it is not lit",
                                statistics));
  }
  return warnings;
}

std::vector<std::string> checkNormal(const NamedLayer& normal) {
  constexpr double kBeyondOne = 1.05;
  const LayerStatistics statistics = statisticsOf(*normal.image);
  std::vector<std::string> warnings = checkEmptiness(normal, statistics);
  if (looksEncoded(*normal.image)) {
    warnings.push_back(sentence(normal,
                                "looks like normals stored as n / 2 + 1 / 2, while [-1, 1] is expected: have the "
                                "renderer write them as they are",
                                statistics));
  }
  if (statistics.minimum < -kBeyondOne || statistics.maximum > kBeyondOne) {
    warnings.push_back(
        sentence(normal, "has components beyond [-1, 1]: check that it holds normals and not positions", statistics));
  }
  return warnings;
}

std::vector<std::string> checkDepth(const NamedLayer& depth) {
  return checkEmptiness(depth, statisticsOf(*depth.image));
}

bool looksEncoded(const Image& normal) {
  constexpr float kNegative = -1e-3F;
  constexpr double kTolerance = 0.1, kNoNormal = 0.1;
  if (normal.channels != 3) {
    return false;
  }
  size_t unitAsStored = 0;
  size_t unitDecoded = 0;
  size_t considered = 0;
  for (size_t i = 0; i < normal.pixels.size(); i += 3) {
    double stored = 0.0;
    double decoded = 0.0;
    for (size_t c = 0; c < 3; ++c) {
      const double value = normal.pixels[i + c];
      if (value < kNegative) {
        return false;
      }
      stored += value * value;
      decoded += (2.0 * value - 1.0) * (2.0 * value - 1.0);
    }
    if (stored > 0.0 && decoded > kNoNormal * kNoNormal) {  // grey is a background whose normal is 0
      ++considered;
      unitAsStored += std::abs(std::sqrt(stored) - 1.0) < kTolerance ? 1 : 0;
      unitDecoded += std::abs(std::sqrt(decoded) - 1.0) < kTolerance ? 1 : 0;
    }
  }
  return unitDecoded * 2 > considered && unitDecoded > unitAsStored;
}

}  // namespace xrds
