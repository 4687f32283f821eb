#include "xrds/merged_colour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "xrds/error.h"

namespace xrds {
namespace {

/// Two renders of a smooth image: samples whose noise has a standard deviation of half the value.
struct Renders {
  Renders(uint32_t side, uint32_t scale, RenderSamples samples, float light = 1) : side(side), scale(scale) {
    std::mt19937 bits(7);
    std::normal_distribution<float> normal;
    const auto fill = [&](uint32_t extent, double count, float level) {
      std::vector<float> pixels;
      for (uint32_t y = 0; y < extent; ++y)
        for (uint32_t x = 0; x < extent; ++x)
          for (int c = 0; c < 3; ++c) {
            const float value =
                level * (1 + std::sin(3.F * static_cast<float>(x + y) / static_cast<float>(extent)) / 2);
            pixels.push_back(std::max(0.F, value * (1 + 0.5F * normal(bits) / static_cast<float>(std::sqrt(count)))));
          }
      return pixels;
    };
    low = fill(side, samples.low, 1);
    full = fill(side * scale, samples.full, light);
  }
  PixelView lowView() const { return {low.data(), side, side}; }
  PixelView fullView() const { return {full.data(), side * scale, side * scale}; }

  uint32_t side, scale;
  std::vector<float> low, full;
};

TEST(MergedColour, WeighsBySamples) {
  EXPECT_DOUBLE_EQ(fullShare({64, 16}, 4), 0.8);
  EXPECT_DOUBLE_EQ(fullShare({16, 1}, 4), 0.5);
  const float low[] = {1, 2, 3, 9}, full[] = {0, 0, 4, 8, 2, 4, 2, 6, 12, -4, 2, 0};  // 1 x 1 of stride 4, 2 x 2
  const auto merged = mergedColour({low, 1, 1, 4}, {full, 2, 2}, 0.25);
  EXPECT_FLOAT_EQ(merged[0], 0.75F * 1 + 0.25F * 2.5F);  // the mean of 0, 8, 2 and, in place of -4, 0
  EXPECT_FLOAT_EQ(merged[1], 0.75F * 2 + 0.25F * (0 + 2 + 6 + 2) / 4);
  EXPECT_FLOAT_EQ(merged[2], 0.75F * 3 + 0.25F * (4 + 4 + 12 + 0) / 4);
}

// From all around, as xrds upscale does, not from the pixels of its square alone.
TEST(MergedColour, FillsWhatIsNotFinite) {
  const float low[] = {1, 1, 1, 5, 5, 5};
  const float bad = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> full(size_t{3} * 8, 3);
  for (int c = 0; c < 3; ++c) {
    full[3 + c] = bad;  // the second pixel of the first row, which has five neighbours
    full[6 + c] = 13;
    full[18 + c] = -4;  // below the latter: 0
  }
  const auto merged = mergedColour({low, 2, 1}, {full.data(), 4, 2}, 0.5);
  for (int c = 0; c < 3; ++c) {
    EXPECT_FLOAT_EQ(merged[c], 0.5F * 1 + 0.5F * (3 + 4.4F + 3 + 3) / 4);
    EXPECT_FLOAT_EQ(merged[3 + c], 0.5F * 5 + 0.5F * (13 + 3 + 0 + 3) / 4);
  }
}

// Before they are merged, as xrds upscale does: afterwards they were filled with their neighbours' share of both.
TEST(MergedColour, RepairsTheLowResolutionColour) {
  const float bad = std::numeric_limits<float>::quiet_NaN();
  const float low[] = {bad, 1, 1, 5, -5, 5};
  std::vector<float> full(size_t{3} * 8, 3);
  const auto merged = mergedColour({low, 2, 1}, {full.data(), 4, 2}, 0.5);
  const float expected[] = {4, 1.5F, 4, 4, 1.5F, 4};  // of both 5, 0, 5
  for (int i = 0; i < 6; ++i) EXPECT_FLOAT_EQ(merged[i], expected[i]) << i;
}

TEST(MergedColour, EstimatesTheShareFromNoise) {
  for (const uint32_t scale : {2u, 4u})
    for (const RenderSamples samples : {RenderSamples{64, 16}, RenderSamples{16, 1}, RenderSamples{4, 4}}) {
      const Renders renders(64, scale, samples);
      const double known = fullShare(samples, scale),
                   estimated = estimatedFullShare(renders.lowView(), renders.fullView());
      const double ratio = estimated / (1 - estimated) / (known / (1 - known));
      EXPECT_GT(ratio, 0.6) << scale << " " << samples.low;
      EXPECT_LT(ratio, 1.6) << scale << " " << samples.low;
    }
}

/// Of a scene in which one sample in twenty meets light, most pixels are black at few samples.
TEST(MergedColour, EstimatesTheShareOfDarkScenes) {
  std::mt19937 bits(7);
  std::bernoulli_distribution meetsLight(0.05);
  const auto render = [&](uint32_t extent, int samples) {
    std::vector<float> pixels;
    for (uint32_t i = 0; i < extent * extent; ++i) {
      float value = 0;
      for (int k = 0; k < samples; ++k) value += meetsLight(bits) ? 1.F / static_cast<float>(samples) : 0;
      pixels.insert(pixels.end(), 3, value);
    }
    return pixels;
  };
  for (const int samples : {4, 16}) {
    const std::vector<float> low = render(64, samples), full = render(128, 1);
    const double known = fullShare({static_cast<double>(samples), 1}, 2),
                 estimated = estimatedFullShare({low.data(), 64, 64}, {full.data(), 128, 128});
    const double ratio = estimated / (1 - estimated) / (known / (1 - known));
    EXPECT_GT(ratio, 0.5) << samples;
    EXPECT_LT(ratio, 2.0) << samples;
  }
}

TEST(MergedColour, AFireflyChangesNoEstimate) {
  Renders renders(32, 2, {16, 4});
  const double before = estimatedFullShare(renders.lowView(), renders.fullView());
  renders.full[3 * 1000] = renders.low[3 * 500] = 1e6F;
  EXPECT_NEAR(estimatedFullShare(renders.lowView(), renders.fullView()), before, 0.01);
}

TEST(MergedColour, TellsOtherLight) {
  const Renders same(32, 4, {16, 1}), darker(32, 4, {16, 1}, 0.7F);
  EXPECT_LT(colourDifference(same.lowView(), same.fullView()), kMostColourDifference / 2);
  EXPECT_GT(colourDifference(darker.lowView(), darker.fullView()), kMostColourDifference);
  const Renders black(32, 4, {16, 1}, 0);
  EXPECT_GT(colourDifference(black.lowView(), black.fullView()), 0.9);
}

TEST(LevelledColour, HasTheMeansOfTheMergedOne) {
  const Renders renders(32, 2, {16, 4});
  const auto merged = mergedColour(renders.lowView(), renders.fullView(), 0.5);
  const PixelView mergedView{merged.data(), 32, 32};
  const auto levelled = levelledColour(renders.fullView(), mergedView);
  const auto means = mergedColour(mergedView, {levelled.data(), 64, 64}, 1);
  for (size_t i = 0; i < merged.size(); ++i) EXPECT_NEAR(means[i], merged[i], 0.02F * (0.1F + merged[i])) << i;
  // One factor for all pixels of a square.
  EXPECT_FLOAT_EQ(levelled[0] * renders.full[3], levelled[3] * renders.full[0]);
}

TEST(LevelledColour, KeepsItsDistanceFromDarkSquares) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> full(size_t{3} * 8, 1e-6F);
  full[3] = nan;  // the red, green and blue of its pixel are filled
  full[1] = -5;
  const std::vector<float> merged{1, 1, 1, 1, 1, 1}, black(6, 0), night(size_t{3} * 8, 0);
  const auto levelled = levelledColour({full.data(), 4, 2}, {merged.data(), 2, 1});
  EXPECT_FLOAT_EQ(levelled[0], 8e-6F);
  EXPECT_EQ(levelled[1], 0);
  EXPECT_FLOAT_EQ(levelled[2], 8e-6F);
  EXPECT_FLOAT_EQ(levelled[3], 8e-6F);
  EXPECT_FLOAT_EQ(levelled[4], 6.4e-6F);  // of five neighbours one is 0
  EXPECT_EQ(levelledColour({night.data(), 4, 2}, {black.data(), 2, 1}), night);
}

TEST(MergedColour, RefusesWhatDoesNotFit) {
  const std::vector<float> pixels(size_t{3} * 100);
  EXPECT_THROW(mergedColour({pixels.data(), 3, 3}, {pixels.data(), 6, 5}, 0.5), Error);
  EXPECT_THROW(mergedColour({pixels.data(), 4, 4}, {pixels.data(), 2, 2}, 0.5), Error);
  EXPECT_THROW(levelledColour({pixels.data(), 6, 5}, {pixels.data(), 3, 3}), Error);
  EXPECT_THROW(estimatedFullShare({pixels.data(), 4, 4}, {pixels.data(), 4, 4}), Error);
  EXPECT_THROW(fullShare({0, 4}, 2), Error);
  EXPECT_THROW(fullShare({4, std::numeric_limits<double>::infinity()}, 2), Error);
}

}  // namespace
}  // namespace xrds
