#include "advice/scene_features.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "image/image_view.h"
#include "image/srgb.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr double kLeast = 0x1p-20;  // of a mean square: the logarithm of an even picture is finite

// What the display shows of the radiance, three channels.
Image picture(const Image& radiance) {
  Image result(radiance.width, radiance.height, 3);
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x)
      for (int c = 0; c < 3; ++c) result.at(x, y, c) = static_cast<float>(displayValue(radiance.at(x, y, c)));
  return result;
}

double meanSquareDifference(const Image& one, const Image& other) {
  double sum = 0;
  for (size_t i = 0; i < one.pixels.size(); ++i) {
    const double difference = static_cast<double>(one.pixels[i]) - static_cast<double>(other.pixels[i]);
    sum += difference * difference;
  }
  return sum / static_cast<double>(one.pixels.size());
}

// The mean product of the differences between neighbours in a row or, `down`, in a column. The noise of the two
// pictures is independent, so that it goes out of the mean.
double meanProductOfSteps(const Image& one, const Image& other, bool down) {
  double sum = 0;
  size_t count = 0;
  for (int y = 0; y + (down ? 1 : 0) < one.height; ++y)
    for (int x = 0; x + (down ? 0 : 1) < one.width; ++x)
      for (int c = 0; c < 3; ++c, ++count) {
        const int nextX = down ? x : x + 1, nextY = down ? y + 1 : y;
        sum += static_cast<double>(one.at(nextX, nextY, c) - one.at(x, y, c)) *
               static_cast<double>(other.at(nextX, nextY, c) - other.at(x, y, c));
      }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

float medianAround(const Image& image, int x, int y, int c) {
  std::array<float, 9> values{};
  size_t count = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      values[count++] = image.at(std::clamp(x + dx, 0, image.width - 1), std::clamp(y + dy, 0, image.height - 1), c);
  std::nth_element(values.begin(), values.begin() + 4, values.end());
  return values[4];
}

// The mean square of what a median of 3 x 3 pixels takes away from values that are first cut off at `least` and 1.
double meanSquareOfOutliers(const Image& image, float least) {
  Image cut(image.width, image.height, 3), medians = cut;
  for (int y = 0; y < cut.height; ++y)
    for (int x = 0; x < cut.width; ++x)
      for (int c = 0; c < 3; ++c) cut.at(x, y, c) = std::clamp(image.at(x, y, c), least, 1.0F);
  for (int y = 0; y < cut.height; ++y)
    for (int x = 0; x < cut.width; ++x)
      for (int c = 0; c < 3; ++c) medians.at(x, y, c) = medianAround(cut, x, y, c);
  return meanSquareDifference(cut, medians);
}

double logarithm(double meanSquare) { return std::log2(std::max(meanSquare, kLeast)); }

}  // namespace

SceneFeatures sceneFeatures(const CheapRenders& renders) {
  const auto& [low, full, albedo, normal, samples] = renders;
  for (const Image* image : {&albedo, &normal})
    if (image->width != full.width || image->height != full.height)
      throw Error("Albedo and normal must have the size of the full-resolution colour.");
  if (!(samples.low > 0) || !(samples.full > 0)) throw Error("Sample counts must be positive.");
  Image mean(low.width, low.height, 3);
  mean.pixels = mergedColour(viewOf(low), viewOf(full), 1);  // throws where the sizes do not fit
  const Image lowPicture = picture(low), meanPicture = picture(mean);
  const double scale = static_cast<double>(full.width) / low.width;
  const double variance =
      meanSquareDifference(lowPicture, meanPicture) / (1 / samples.low + 1 / (scale * scale * samples.full));
  const double steps =
      meanProductOfSteps(lowPicture, meanPicture, false) + meanProductOfSteps(lowPicture, meanPicture, true);
  const double outliers = meanSquareOfOutliers(albedo, 0) + meanSquareOfOutliers(normal, -1);
  return {logarithm(variance), logarithm(steps), logarithm(outliers * samples.full)};
}

}  // namespace xrds
