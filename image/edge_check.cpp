#include "image/edge_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace xrds {
namespace {

constexpr float kColorStep = 0.5F;      // Of log brightness, after smoothing.
constexpr float kAuxStep = 0.05F;       // Of any component of albedo or normal.
constexpr double kEnoughEdges = 0.005;  // The share of pixels on an edge below which the colour says nothing.
constexpr double kSharedEdges = 0.05;

using Mask = std::vector<uint8_t>;

// The largest step to the right or the lower neighbour exceeds the limit.
Mask edgesOf(const Image& image, float limit) {
  Mask mask(image.pixelCount());
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int right = std::min(x + 1, image.width - 1);
      const int below = std::min(y + 1, image.height - 1);
      float step = 0.0F;
      for (int c = 0; c < image.channels; ++c) {
        const float value = image.at(x, y, c);
        step = std::max({step, std::abs(image.at(right, y, c) - value), std::abs(image.at(x, below, c) - value)});
      }
      mask[image.index(x, y) / size_t(image.channels)] = step > limit ? 1 : 0;
    }
  }
  return mask;
}

// The mean over the pixel and its neighbours within `radius`, which takes noise off.
Image smoothed(const Image& image, int radius) {
  Image result(image.width, image.height, 1);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      float sum = 0.0F;
      int count = 0;
      for (int v = std::max(y - radius, 0); v <= std::min(y + radius, image.height - 1); ++v) {
        for (int u = std::max(x - radius, 0); u <= std::min(x + radius, image.width - 1); ++u) {
          sum += image.at(u, v, 0);
          ++count;
        }
      }
      result.at(x, y, 0) = sum / static_cast<float>(count);
    }
  }
  return result;
}

// The logarithm of the channels' mean, kept from falling without end in the dark.
Image logBrightness(const Image& color) {
  constexpr double kFloorOverMean = 0.01;
  Image result(color.width, color.height, 1);
  const auto channels = static_cast<size_t>(color.channels);
  double total = 0.0;
  for (size_t i = 0; i < color.pixels.size(); ++i) {
    const float value = std::isfinite(color.pixels[i]) ? std::max(color.pixels[i], 0.0F) : 0.0F;
    result.pixels[i / channels] += value / static_cast<float>(color.channels);
    total += value;
  }
  const auto floor = static_cast<float>(kFloorOverMean * total / static_cast<double>(color.pixels.size()) + 1e-20);
  std::transform(result.pixels.begin(), result.pixels.end(), result.pixels.begin(),
                 [floor](float value) { return std::log(value + floor); });
  return result;
}

// The mean over blocks of the layer, so that it has the size of the colour; nothing when the sizes do not divide.
std::optional<Image> shrunkTo(const Image& layer, int width, int height) {
  if (layer.width % width != 0 || layer.height % height != 0 || layer.width == 0 || layer.height == 0) {
    return std::nullopt;
  }
  const int blockWidth = layer.width / width;
  const int blockHeight = layer.height / height;
  Image result(width, height, layer.channels);
  for (int y = 0; y < layer.height; ++y) {
    for (int x = 0; x < layer.width; ++x) {
      for (int c = 0; c < layer.channels; ++c) {
        const float value = layer.at(x, y, c);
        result.at(x / blockWidth, y / blockHeight, c) +=
            std::isfinite(value) ? value / static_cast<float>(blockWidth * blockHeight) : 0.0F;
      }
    }
  }
  return result;
}

Mask grown(const Mask& mask, int width, int height) {
  Mask result(mask.size());
  const auto position = [width](int x, int y) { return static_cast<size_t>(y) * size_t(width) + size_t(x); };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
          result[position(x, y)] |= mask[position(u, v)];
        }
      }
    }
  }
  return result;
}

}  // namespace

std::vector<std::string> checkEdges(const Image& color, const std::vector<NamedLayer>& layers) {
  if (color.pixels.empty()) {
    return {};
  }
  Mask auxEdges(color.pixelCount());
  std::string names;
  for (const NamedLayer& layer : layers) {
    if (const std::optional<Image> small = shrunkTo(*layer.image, color.width, color.height)) {
      const Mask edges = grown(edgesOf(*small, kAuxStep), color.width, color.height);
      std::transform(edges.begin(), edges.end(), auxEdges.begin(), auxEdges.begin(),
                     [](uint8_t a, uint8_t b) { return static_cast<uint8_t>(a | b); });
      names += (names.empty() ? "'" : " and '") + layer.name + "'";
    }
  }
  const Mask colorEdges = edgesOf(smoothed(logBrightness(color), 1), kColorStep);
  const auto edgeCount = static_cast<double>(std::count(colorEdges.begin(), colorEdges.end(), 1));
  double shared = 0.0;
  for (size_t pixel = 0; pixel < colorEdges.size(); ++pixel) {
    shared += colorEdges[pixel] & auxEdges[pixel];
  }
  if (names.empty() || edgeCount < kEnoughEdges * static_cast<double>(color.pixelCount()) ||
      shared >= kSharedEdges * edgeCount) {
    return {};
  }
  return {"The auxiliary layers " + names + " have no edges where the colour has them (" + std::to_string(int(shared)) +
          " of " + std::to_string(int(edgeCount)) + " strong edges shared): check that they belong to the same frame " +
          "and camera and are not blank. Where the colour's only edges are shadows, all is well."};
}

}  // namespace xrds
