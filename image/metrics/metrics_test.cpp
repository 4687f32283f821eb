#include "image/metrics/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "image/metrics/flip.h"
#include "xrds/error.h"

namespace xrds {
namespace {

Image imageOf(int width, int height, int channels, std::vector<float> values) {
  Image image(width, height, channels);
  image.pixels = std::move(values);
  return image;
}

TEST(Metrics, PsnrByHand) {
  // sRGB of 0.2140411 is 0.5 and of 1 is 1: a difference of 0.5 in one value of three.
  const Image reference = imageOf(1, 1, 3, {1.0F, 0.0F, 0.3F});
  const Image result = imageOf(1, 1, 3, {0.21404114F, 0.0F, 0.3F});
  EXPECT_NEAR(psnr(result, reference), 10.0 * std::log10(3.0 / 0.25), 1e-5);
  EXPECT_NEAR(psnr(Image(2, 2, 3, 1.0F), Image(2, 2, 3)), 0.0, 1e-12);
}

TEST(Metrics, PsnrClampsAndIsInfiniteForEqualImages) {
  EXPECT_TRUE(std::isinf(psnr(Image(2, 2, 3, 5.0F), Image(2, 2, 3, 9.0F))));
  EXPECT_TRUE(std::isinf(psnr(Image(2, 2, 3, -5.0F), Image(2, 2, 3, 0.0F))));
}

TEST(Metrics, RelMseByHand) {
  // (0.3 - 0.1)^2 / (0.01 + 0.01) = 2; (2 - 0)^2 / 0.01 = 400; equal values give 0.
  const Image reference = imageOf(2, 1, 2, {0.1F, 1.0F, 0.0F, 4.0F});
  const Image result = imageOf(2, 1, 2, {0.3F, 1.0F, 2.0F, 4.0F});
  const Image map = relMseMap(result, reference);
  EXPECT_NEAR(map.at(0, 0, 0), 1.0, 1e-6);
  EXPECT_NEAR(map.at(1, 0, 0), 200.0, 1e-4);
}

TEST(Metrics, TrimmingMedianAndPercentileByHand) {
  // 2000 black pixels; the result is wrong in 1, 2 and 3 of them so that their values are 100, 400 and 900.
  Image result(50, 40, 3);
  const Image reference(50, 40, 3);
  for (int pixel = 0; pixel < 3; ++pixel) {
    for (int c = 0; c < 3; ++c) {
      result.at(7 * pixel, 5, c) = static_cast<float>(pixel + 1);
    }
  }
  const Metrics metrics = measure(result, reference);
  EXPECT_NEAR(metrics.relMse, 1400.0 / 2000.0, 1e-6);
  EXPECT_NEAR(metrics.relMseTrimmed, 100.0 / 1998.0, 1e-6);
  EXPECT_EQ(metrics.relMseMedian, 0.0);
  EXPECT_NEAR(metrics.relMsePercentile999, 100.0, 1e-3);
  EXPECT_EQ(metrics.flip, flip(result, reference));
  EXPECT_EQ(metrics.psnr, psnr(result, reference));
}

TEST(Metrics, MedianOfAnEvenNumberIsTheMeanOfTheMiddle) {
  const Image reference(4, 1, 3);
  Image result(4, 1, 3);
  const float values[] = {0.1F, 0.2F, 0.3F, 0.4F};
  for (int x = 0; x < 4; ++x) {
    for (int c = 0; c < 3; ++c) {
      result.at(x, 0, c) = values[x];
    }
  }
  const Metrics metrics = measure(result, reference);
  EXPECT_NEAR(metrics.relMseMedian, 0.5 * (4.0 + 9.0), 1e-5);
  EXPECT_NEAR(metrics.relMsePercentile999, 16.0, 1e-5);
  EXPECT_NEAR(metrics.relMseTrimmed, metrics.relMse, 1e-12);
}

TEST(Metrics, RefuseWhatCannotBeCompared) {
  const Image image(2, 2, 3, 0.5F);
  Image hole = image;
  hole.pixels[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(measure(image, Image(2, 3, 3))), Error);
  EXPECT_THROW(static_cast<void>(measure(Image(), Image())), Error);
  EXPECT_THROW(static_cast<void>(measure(hole, image)), Error);
  EXPECT_THROW(static_cast<void>(measure(image, hole)), Error);
  EXPECT_THROW(static_cast<void>(measure(Image(2, 2, 1), Image(2, 2, 1))), Error);
}

TEST(Metrics, HaveOneDefinitionEach) { EXPECT_EQ(metricDefinitions().size(), 6U); }

}  // namespace
}  // namespace xrds
