#include "image/compose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "image/srgb.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using Color = std::array<double, 3>;

// Display colours at even distances; between them the map is linear.
constexpr std::array<Color, 7> kHeatColors = {{{0.27, 0.00, 0.33},
                                               {0.27, 0.22, 0.51},
                                               {0.19, 0.41, 0.56},
                                               {0.13, 0.57, 0.55},
                                               {0.21, 0.72, 0.47},
                                               {0.56, 0.84, 0.27},
                                               {0.99, 0.91, 0.14}}};
constexpr Color kMagenta = {1.0, 0.0, 1.0};

Color heatColor(double share) {
  if (std::isnan(share)) {
    return kMagenta;
  }
  const double position = std::clamp(share, 0.0, 1.0) * (kHeatColors.size() - 1);
  const size_t below = std::min(static_cast<size_t>(position), kHeatColors.size() - 2);
  const double weight = position - static_cast<double>(below);
  Color color{};
  for (size_t c = 0; c < 3; ++c) {
    color[c] = (1.0 - weight) * kHeatColors[below][c] + weight * kHeatColors[below + 1][c];
  }
  return color;
}

std::string sizeOf(const Image& image) {
  return std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels of " +
         std::to_string(image.channels) + " channels";
}

}  // namespace

Image enlargeNearest(const Image& image, int scale) {
  if (scale < 1) {
    throw Error("An image cannot be enlarged " + std::to_string(scale) + " times: expected a positive whole number.");
  }
  Image result(image.width * scale, image.height * scale, image.channels);
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      std::copy_n(&image.pixels[image.index(x / scale, y / scale)], image.channels, &result.pixels[result.index(x, y)]);
    }
  }
  return result;
}

Image sideBySide(const std::vector<Image>& images, int gap) {
  if (images.empty() || gap < 0) {
    throw Error("A comparison needs at least one image and no negative gap: found " + std::to_string(images.size()) +
                " images and a gap of " + std::to_string(gap) + ".");
  }
  int width = gap * static_cast<int>(images.size() - 1);
  for (const Image& image : images) {
    if (image.height != images.front().height || image.channels != images.front().channels) {
      throw Error("Images side by side need one height: expected that of " + sizeOf(images.front()) + ", found " +
                  sizeOf(image) + "; enlarge the smaller one.");
    }
    width += image.width;
  }
  Image result(width, images.front().height, images.front().channels);
  int column = 0;
  for (const Image& image : images) {
    const auto rowLength = static_cast<size_t>(image.width) * static_cast<size_t>(image.channels);
    for (int y = 0; y < image.height && rowLength > 0; ++y) {
      std::copy_n(&image.pixels[image.index(0, y)], rowLength, &result.pixels[result.index(column, y)]);
    }
    column += image.width + gap;
  }
  return result;
}

Image heatMap(const Image& error, float maximum) {
  if (error.channels != 1 || !(maximum > 0.0F)) {
    throw Error("An error map is shown from one channel and a positive maximum: found " + sizeOf(error) +
                " and a maximum of " + std::to_string(maximum) + ".");
  }
  Image result(error.width, error.height, 3);
  for (size_t pixel = 0; pixel < error.pixels.size(); ++pixel) {
    const Color color = heatColor(double{error.pixels[pixel]} / maximum);
    for (size_t c = 0; c < 3; ++c) {
      result.pixels[pixel * 3 + c] = static_cast<float>(linearFromSrgb(color[c]));
    }
  }
  return result;
}

}  // namespace xrds
