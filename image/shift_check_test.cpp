#include "image/shift_check.h"

#include <gtest/gtest.h>

#include <cmath>

namespace xrds::test {
namespace {

constexpr int kScale = 4, kWidth = 24, kHeight = 20;

// A picture with edges in both directions, brighter and darker by noise of one pixel, moved by (dx, dy).
Image picture(int dx, int dy, float noise) {
  Image image(kScale * kWidth, kScale * kHeight, 3);
  uint32_t seed = 7;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      seed = seed * 1664525 + 1013904223;
      const bool isBright = ((x - dx + 64) / 9 + (y - dy + 64) / 7) % 2 == 0;
      const float factor = 1.0F + noise * (float(seed >> 8) / float(1 << 24) - 0.5F);
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = (isBright ? 2.0F : 0.2F) * factor;
    }
  return image;
}

Image meansOf(const Image& full) {
  Image low(kWidth, kHeight, 3);
  for (int y = 0; y < full.height; ++y)
    for (int x = 0; x < full.width; ++x)
      for (int c = 0; c < 3; ++c) low.at(x / kScale, y / kScale, c) += full.at(x, y, c) / (kScale * kScale);
  return low;
}

TEST(ShiftCheck, IsSilentWhereBothShowTheSame) {
  for (const float noise : {0.0F, 1.0F, 2.0F}) {
    const Image full = picture(0, 0, noise);
    EXPECT_TRUE(checkShift(meansOf(picture(0, 0, 0.0F)), {"beauty", &full}).empty()) << noise;
  }
}

TEST(ShiftCheck, TellsTheStep) {
  const Image full = picture(0, 0, 1.0F);
  const auto said = checkShift(meansOf(picture(0, 3, 0.0F)), {"beauty", &full});
  ASSERT_EQ(said.size(), 1U);
  EXPECT_NE(said[0].find("'beauty'"), std::string::npos) << said[0];
  EXPECT_NE(said[0].find("by 3 pixels down"), std::string::npos) << said[0];
  const auto other = checkShift(meansOf(picture(-2, -1, 0.0F)), {"beauty", &full});
  ASSERT_EQ(other.size(), 1U);
  EXPECT_NE(other[0].find("by 2 pixels to the left and 1 pixel up"), std::string::npos) << other[0];
}

TEST(ShiftCheck, SaysNothingOfNoiseEvenOrBlackImagesAndOtherSizes) {
  Image even(kScale * kWidth, kScale * kHeight, 3), noise = even;
  uint32_t seed = 3;
  for (float& value : noise.pixels) value = float((seed = seed * 1664525 + 1013904223) >> 8);
  EXPECT_TRUE(checkShift(meansOf(even), {"black", &even}).empty());
  std::fill(even.pixels.begin(), even.pixels.end(), 0.5F);
  EXPECT_TRUE(checkShift(meansOf(even), {"even", &even}).empty());
  EXPECT_TRUE(checkShift(meansOf(even), {"noise", &noise}).empty());
  EXPECT_TRUE(checkShift(Image(kWidth, kHeight + 1, 3), {"even", &even}).empty());
  EXPECT_TRUE(checkShift(Image(), {"even", &even}).empty());
}

}  // namespace
}  // namespace xrds::test
