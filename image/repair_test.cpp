#include "image/repair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace xrds {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Image singleChannel(int width, int height, std::vector<float> values) {
  Image image(width, height, 1);
  image.pixels = std::move(values);
  return image;
}

TEST(Repair, TakesTheMeanOfTheFiniteNeighbours) {
  Image image = singleChannel(3, 3, {1, 2, 3, 4, kNan, 6, 7, 8, 9});
  EXPECT_EQ(repairNonFinite(image), (RepairCounts{1, 0}));
  EXPECT_FLOAT_EQ(image.at(1, 1, 0), 5.0F);
  EXPECT_EQ(repairNonFinite(image), (RepairCounts{0, 0}));
}

TEST(Repair, FillsCornersFromWhatThereIs) {
  Image image = singleChannel(2, 2, {kInfinity, 2, -kInfinity, 4});
  EXPECT_EQ(repairNonFinite(image).nonFinitePixels, 2U);
  EXPECT_EQ(image.pixels, (std::vector<float>{3, 2, 3, 4}));
}

TEST(Repair, GrowsInwardRingByRing) {
  Image image = singleChannel(5, 1, {8, kNan, kNan, kNan, 4});
  EXPECT_EQ(repairNonFinite(image).nonFinitePixels, 3U);
  EXPECT_EQ(image.pixels, (std::vector<float>{8, 8, 6, 4, 4}));
}

TEST(Repair, OneBadChannelSpoilsItsPixelOnly) {
  Image image(3, 1, 3);
  image.pixels = {1, 1, 1, 9, kNan, 9, 3, 5, 7};
  EXPECT_EQ(repairNonFinite(image).nonFinitePixels, 1U);
  EXPECT_EQ(image.pixels, (std::vector<float>{1, 1, 1, 2, 3, 4, 3, 5, 7}));
}

TEST(Repair, NothingFiniteBecomesZero) {
  Image image(4, 4, 2, kNan);
  EXPECT_EQ(repairNonFinite(image).nonFinitePixels, 16U);
  EXPECT_EQ(image, Image(4, 4, 2));
  Image empty;
  EXPECT_EQ(repairNonFinite(empty), RepairCounts());
}

TEST(Repair, LargeHolesAreFilled) {
  Image image(301, 257, 3, kNan);
  for (int c = 0; c < 3; ++c) {
    image.at(0, 0, c) = 2.0F;
  }
  EXPECT_EQ(repairNonFinite(image).nonFinitePixels, image.pixelCount() - 1);
  EXPECT_EQ(image, Image(301, 257, 3, 2.0F));
}

TEST(Repair, RadianceLosesNegativesAndKeepsHighlights) {
  Image image(3, 1, 3);
  image.pixels = {-1, -2, 3, 1e30F, 0.5F, 0, kNan, -4, 1};
  const RepairCounts counts = repairRadiance(image);
  EXPECT_EQ(counts, (RepairCounts{1, 1}));
  EXPECT_EQ(image.pixels, (std::vector<float>{0, 0, 3, 1e30F, 0.5F, 0, 1e30F, 0.5F, 0}));
}

TEST(Repair, FillsHolesWithoutNegativeRadiance) {
  Image image(3, 1, 1);
  image.pixels = {-9, kNan, 1};
  EXPECT_EQ(repairRadiance(image), (RepairCounts{1, 1}));
  EXPECT_EQ(image.pixels, (std::vector<float>{0, 0.5F, 1}));
}

}  // namespace
}  // namespace xrds
