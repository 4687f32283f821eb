#include "advice/scene_features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "image/srgb.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr int kScale = 4, kLow = 64, kFull = kScale * kLow;

// Radiance whose picture is `shown`.
float radianceOf(double shown) { return static_cast<float>(linearFromSrgb(shown)); }

// Even radiance; of the picture a standard deviation of `sigma` a sample, divided by the root of the samples. The means
// of scale x scale pixels of the full one are those of radiance: at so little noise the curve is as good as straight.
struct Noisy {
  Image low{kLow, kLow, 3}, full{kFull, kFull, 3}, guides{kFull, kFull, 3, 0.5F};

  Noisy(double sigma, RenderSamples samples) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (float& value : low.pixels) value = radianceOf(0.5 + sigma / std::sqrt(samples.low) * normal(random));
    for (float& value : full.pixels) value = radianceOf(0.5 + sigma / std::sqrt(samples.full) * normal(random));
  }
};

TEST(SceneFeatures, NoiseIsThatOfOneSampleWhateverTheCounts) {
  for (const RenderSamples samples : {RenderSamples{1, 1}, {4, 1}, {64, 2}}) {
    const Noisy renders(0.02, samples);
    const SceneFeatures found = sceneFeatures({renders.low, renders.full, renders.guides, renders.guides, samples});
    EXPECT_NEAR(found.noise, std::log2(0.02 * 0.02), 0.1) << samples.low;
    EXPECT_LT(found.detail, found.noise - 3) << "noise must not count as detail";
    EXPECT_EQ(found.guideNoise, -20) << "even guides have none";
  }
}

TEST(SceneFeatures, DetailIsTheMeanSquareOfStepsBetweenNeighbours) {
  const double step = 1.0 / 128;
  Image low(kLow, kLow, 3), full(kFull, kFull, 3);
  for (int y = 0; y < kFull; ++y)
    for (int x = 0; x < kFull; ++x)
      for (int c = 0; c < 3; ++c)
        full.at(x, y, c) = low.at(x / kScale, y / kScale, c) = radianceOf(0.2 + step * std::floor(x / double{kScale}));
  const Image guides(kFull, kFull, 3, 0.5F);
  const SceneFeatures found = sceneFeatures({low, full, guides, guides, {1, 1}});
  EXPECT_NEAR(found.detail, std::log2(step * step), 1e-3);  // in rows; columns are even
  EXPECT_EQ(found.noise, -20);
}

TEST(SceneFeatures, GuideNoiseIsWhatAMedianTakesAway) {
  const Image low(kLow, kLow, 3, 0.5F), full(kFull, kFull, 3, 0.5F), normal(kFull, kFull, 3, 0.0F);
  Image albedo(kFull, kFull, 3, 0.5F);
  size_t outliers = 0;
  for (int y = 4; y < kFull; y += 8)
    for (int x = 4; x < kFull; x += 8, ++outliers) albedo.at(x, y, 0) = 40;  // counts as 1
  const double meanSquare = 0.25 * static_cast<double>(outliers) / static_cast<double>(albedo.pixels.size());
  EXPECT_NEAR(sceneFeatures({low, full, albedo, normal, {1, 1}}).guideNoise, std::log2(meanSquare), 1e-6);
  EXPECT_NEAR(sceneFeatures({low, full, albedo, normal, {1, 4}}).guideNoise, std::log2(4 * meanSquare), 1e-6);
}

TEST(SceneFeatures, SizesAndCountsMustFit) {
  const Image low(kLow, kLow, 3), full(kFull, kFull, 3), odd(kFull + 1, kFull, 3);
  EXPECT_THROW(sceneFeatures({low, full, odd, full, {1, 1}}), Error);
  EXPECT_THROW(sceneFeatures({low, odd, odd, odd, {1, 1}}), Error);
  EXPECT_THROW(sceneFeatures({low, full, full, full, {0, 1}}), Error);
}

}  // namespace
}  // namespace xrds
