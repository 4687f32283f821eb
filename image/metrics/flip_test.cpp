#include "image/metrics/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "image/metrics/flip_filters.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 72;

// Ramps in red and green, a checkerboard in blue.
Image testCard() {
  Image image(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      image.at(x, y, 0) = static_cast<float>(x) / kWidth;
      image.at(x, y, 1) = static_cast<float>(y) / kHeight;
      image.at(x, y, 2) = static_cast<float>((x / 12 + y / 9) % 2) * 0.75F;
    }
  }
  return image;
}

Image noisy() {
  Image image = testCard();
  uint32_t state = 1;
  for (float& value : image.pixels) {
    state = state * 1664525U + 1013904223U;
    value = std::clamp(value + (static_cast<float>(state >> 8U) / 16777216.0F - 0.5F) * 0.4F, 0.0F, 1.0F);
  }
  return image;
}

Image shifted() {
  const Image card = testCard();
  Image image = card;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) {
        image.at(x, y, c) = card.at((x + kWidth - 1) % kWidth, y, c);
      }
    }
  }
  return image;
}

Image mapped(float (*change)(float)) {
  Image image = testCard();
  std::transform(image.pixels.begin(), image.pixels.end(), image.pixels.begin(), change);
  return image;
}

Image spotted() {
  Image image = testCard();
  for (int y = 30; y < 33; ++y) {
    std::fill_n(&image.at(40, y, 0), 9, 1.0F);
  }
  return image;
}

struct Case {
  const char* name;
  Image result;
  double mean;
  double topLeft;
  double inside;  ///< At (41, 31).
  double bottomRight;
};
void PrintTo(const Case& image, std::ostream* out) { *out << image.name; }

class Flip : public ::testing::TestWithParam<Case> {};

// The numbers are those of NVIDIA's evaluator (PyPI flip-evaluator 1.7, LDR, linear input, ppd 67), which
// computes in single precision.
TEST_P(Flip, AgreesWithTheAuthorsEvaluator) {
  constexpr double kAgreement = 5e-5;
  const Case& expected = GetParam();
  const Image map = flipMap(expected.result, testCard());
  EXPECT_NEAR(flip(expected.result, testCard()), expected.mean, kAgreement);
  EXPECT_NEAR(map.at(0, 0, 0), expected.topLeft, kAgreement);
  EXPECT_NEAR(map.at(41, 31, 0), expected.inside, kAgreement);
  EXPECT_NEAR(map.at(kWidth - 1, kHeight - 1, 0), expected.bottomRight, kAgreement);
}

INSTANTIATE_TEST_SUITE_P(Metrics, Flip,
                         ::testing::Values(Case{"Noise", noisy(), 0.2155138, 0.420222, 0.228058, 0.384984},
                                           Case{"Shift", shifted(), 0.1589738, 0.978082, 0.104892, 0.039245},
                                           Case{"Darker", mapped([](float v) { return 0.5F * v; }), 0.6681346, 0.142833,
                                                0.678676, 0.957054},
                                           Case{"Inverted", mapped([](float v) { return 1.0F - v; }), 0.9067295,
                                                0.965874, 0.953872, 0.997155},
                                           Case{"Spot", spotted(), 0.0050071, 0.0, 0.859867, 0.0},
                                           Case{"BeyondOne", mapped([](float v) { return 3.0F * v; }), 0.7407143,
                                                0.391397, 0.96444, 0.197575}),
                         [](const auto& flipCase) { return flipCase.param.name; });

TEST(FlipMap, IsZeroForEqualAndOneForOppositeImages) {
  EXPECT_EQ(flip(testCard(), testCard()), 0.0);
  Image green(20, 10, 3);
  Image blue(20, 10, 3);
  for (size_t pixel = 0; pixel < green.pixelCount(); ++pixel) {
    green.pixels[pixel * 3 + 1] = 1.0F;
    blue.pixels[pixel * 3 + 2] = 1.0F;
  }
  EXPECT_NEAR(flip(green, blue), 1.0, 1e-4);
}

TEST(FlipMap, HardlyMindsWhichImageIsWhich) { EXPECT_DOUBLE_EQ(flip(noisy(), testCard()), flip(testCard(), noisy())); }

TEST(FlipMap, RefusesOtherChannelsAndSizes) {
  EXPECT_THROW(static_cast<void>(flip(Image(4, 4, 1), Image(4, 4, 1))), Error);
  EXPECT_THROW(static_cast<void>(flip(Image(4, 4, 3), Image(4, 5, 3))), Error);
  EXPECT_THROW(static_cast<void>(flipMap(Image(4, 4, 3), Image(4, 4, 3), 0.0)), Error);
}

TEST(FlipFilters, AreNormalized) {
  double positive = 0.0;
  double negative = 0.0;
  for (const double value : gaussianCurvature(2.7, 9)) {
    (value > 0.0 ? positive : negative) += value;
  }
  EXPECT_NEAR(positive, 1.0, 1e-12);
  EXPECT_NEAR(negative, -1.0, 1e-12);
  const Image flat(5, 4, 1, 0.25F);
  EXPECT_EQ(filtered(flat, {gaussian(1.5, 6), gaussian(0.5, 2)}), flat);
}

}  // namespace
}  // namespace xrds
