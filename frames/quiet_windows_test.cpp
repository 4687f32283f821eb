#include "frames/quiet_windows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "xrds/error.h"

namespace xrds {
namespace {

const NetworkConfig kConfig{.scale = 2, .window = 8};
constexpr uint32_t kWidth = 44, kHeight = 29;  // 6 x 4 windows, the last ones cut
constexpr float kBound = 0.02f;

/// An even surface: radiance 0.5, albedo 0.3, one normal.
struct Frame {
  std::vector<float> colour = std::vector<float>(3 * kWidth * kHeight, 0.5f);
  std::vector<float> albedo = std::vector<float>(12 * kWidth * kHeight, 0.3f);
  std::vector<float> normal = std::vector<float>(12 * kWidth * kHeight, 0.5f);

  std::vector<PixelView> auxiliary() const {
    return {{albedo.data(), 2 * kWidth, 2 * kHeight}, {normal.data(), 2 * kWidth, 2 * kHeight}};
  }
  QuietWindows windows(float bound = kBound) const {
    return {kConfig, {colour.data(), kWidth, kHeight}, auxiliary(), 1.f, bound};
  }
  WindowMask needed(float bound = kBound) const { return windows(bound).needed(); }
};

float& low(std::vector<float>& image, uint32_t x, uint32_t y, uint32_t c) { return image[3 * (y * kWidth + x) + c]; }
float& high(std::vector<float>& image, uint32_t x, uint32_t y, uint32_t c) {
  return image[3 * (y * 2 * kWidth + x) + c];
}

TEST(QuietWindows, NeedsNothingInAnEvenFrame) { EXPECT_EQ(Frame().needed().count(), 0U); }

TEST(QuietWindows, NeedsTheWindowsWithinTwoPixelsOfADifferentOne) {
  Frame inside;
  low(inside.colour, 20, 12, 1) = 0.6f;  // in the middle of window (1, 2)
  WindowMask expected({kHeight, kWidth}, 8, false);
  expected.at(1, 2) = 1;
  EXPECT_EQ(inside.needed(), expected);
  Frame corner;
  low(corner.colour, 17, 14, 0) = 0.4f;  // two pixels from windows (1, 1), (2, 1) and (2, 2)
  expected.at(1, 1) = expected.at(2, 1) = expected.at(2, 2) = 1;
  EXPECT_EQ(corner.needed(), expected);
}

TEST(QuietWindows, NeedsWindowsWithAnEdgeOrNoiseInAnyImage) {
  WindowMask expected({kHeight, kWidth}, 8, false);
  expected.at(3, 5) = 1;
  const uint32_t x = 2 * 43, y = 2 * 28;
  Frame edge;
  high(edge.normal, x, y, 2) = 0.1f;
  EXPECT_EQ(edge.needed(), expected);
  Frame noise;
  high(noise.albedo, x + 1, y, 0) = 0.32f;
  EXPECT_EQ(noise.needed(), expected);
  Frame small;  // differences below the bounds
  high(small.normal, x, y, 2) += 1.f / 256;
  high(small.albedo, x, y, 0) = 0.3005f;
  low(small.colour, 43, 28, 1) = 0.5005f;
  EXPECT_EQ(small.needed().count(), 0U);
}

TEST(QuietWindows, BackgroundMayVaryMore) {
  for (const auto& [albedo, normal, needed] :
       {std::tuple(0.32f, 0.5f, 1u), {0.32f, 0.f, 0u}, {0.36f, 0.f, 0u}, {0.6f, 0.f, 1u}, {0.31f, 1e-3f, 1u}}) {
    Frame frame;
    std::fill(frame.normal.begin(), frame.normal.end(), normal);
    high(frame.albedo, 2 * 43, 2 * 28, 0) = albedo;
    EXPECT_EQ(frame.needed().count(), needed) << albedo << " " << normal;
  }
  Frame frame;
  std::fill(frame.normal.begin(), frame.normal.end(), 0.f);
  low(frame.colour, 43, 28, 0) = 0.53f;
  EXPECT_EQ(frame.needed().count(), 0U);
  high(frame.normal, 2 * 43, 2 * 28, 0) = 1e-4f;
  EXPECT_EQ(frame.needed().count(), 1U);
}

TEST(QuietWindows, TakesTextureThatTheColourFollowsForQuiet) {
  Frame sky;  // a gradient that both have, as the background of a renderer that stores radiance as albedo
  for (uint32_t y = 0; y < 2 * kHeight; ++y)
    for (uint32_t x = 0; x < 2 * kWidth; ++x)
      for (uint32_t c = 0; c < 3; ++c) high(sky.albedo, x, y, c) = 0.3f + 0.2f * static_cast<float>(y) / kHeight;
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x)
      for (uint32_t c = 0; c < 3; ++c)
        low(sky.colour, x, y, c) = 0.5f * (high(sky.albedo, 2 * x, 2 * y, c) + high(sky.albedo, 2 * x, 2 * y + 1, c));
  EXPECT_EQ(sky.needed(0.05f).count(), 0U);
}

TEST(QuietWindows, NeedsWindowsWithNumbersThatAreNone) {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    Frame colour, albedo, normal;
    low(colour.colour, 0, 0, 0) = bad;
    high(albedo.albedo, 1, 1, 1) = bad;
    high(normal.normal, 0, 1, 2) = bad;
    EXPECT_EQ(colour.needed().count(), 1U) << bad;
    EXPECT_EQ(albedo.needed().count(), 1U) << bad;
    EXPECT_EQ(normal.needed().count(), 1U) << bad;
  }
  Frame negative;  // taken as black, as the network takes it
  std::fill(negative.colour.begin(), negative.colour.end(), -1.f);
  EXPECT_EQ(negative.needed().count(), 0U);
}

TEST(QuietWindows, FillsWhatIsMarkedWithTheInterpolatedColour) {
  Frame frame;
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x) low(frame.colour, x, y, 0) = 0.5f + 0.001f * static_cast<float>(x);
  high(frame.albedo, 21, 3, 1) = 0.301f;
  const QuietWindows windows = frame.windows();
  ASSERT_EQ(windows.needed().count(), 0U);
  WindowMask marked({kHeight, kWidth}, 8, false);
  marked.at(0, 1) = 1;
  std::vector<float> output(12 * kWidth * kHeight, -1.f);
  windows.fill(marked, output);
  for (uint32_t y = 0; y < 2 * kHeight; ++y)
    for (uint32_t x = 0; x < 2 * kWidth; ++x) {
      const bool filled = y < 16 && x >= 16 && x < 32;
      const float red = 0.5f + 0.001f * (static_cast<float>(x) / 2 - 0.25f);
      EXPECT_NEAR(high(output, x, y, 0), filled ? red : -1.f, 1e-4) << x << " " << y;
      EXPECT_NEAR(high(output, x, y, 2), filled ? 0.5f : -1.f, 1e-6);
    }
  EXPECT_GT(high(output, 21, 3, 1), high(output, 21, 1, 1));  // the albedo's detail stays
}

TEST(QuietWindows, WorksWithoutAuxiliaryImages) {
  const NetworkConfig plain{.scale = 2, .auxInputs = {}, .window = 8, .base = BaseImage::bicubic};
  Frame frame;
  low(frame.colour, 0, 0, 0) = 1;
  const QuietWindows windows(plain, {frame.colour.data(), kWidth, kHeight}, {}, 1.f, kBound);
  EXPECT_EQ(windows.needed().count(), 1U);
  std::vector<float> output(12 * kWidth * kHeight, -1.f);
  windows.fill(WindowMask({kHeight, kWidth}, 8, true), output);
  EXPECT_EQ(high(output, 2 * kWidth - 1, 2 * kHeight - 1, 2), 0.5f);
}

TEST(QuietWindows, RefusesModelsWhoseBaseCannotStandForThem) {
  NetworkConfig config;
  EXPECT_TRUE(whyNeverQuiet(config).empty());
  config.transfer = Transfer::none;
  EXPECT_FALSE(whyNeverQuiet(config).empty());
  config = {.base = BaseImage::none};
  EXPECT_FALSE(whyNeverQuiet(config).empty());
  const float colour[3] = {};
  EXPECT_THROW(QuietWindows(config, {colour, 1, 1}, {}, 1.f, kBound), Error);
}

}  // namespace
}  // namespace xrds
