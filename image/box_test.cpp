#include "image/box.h"

#include <gtest/gtest.h>

#include <limits>

#include "xrds/error.h"

namespace xrds {
namespace {

TEST(Box, ScalesExactly) {
  EXPECT_EQ(scaledBox({0, 0, 63, 47}, 4), (Box{0, 0, 255, 191}));
  EXPECT_EQ(scaledBox({-2, -3, 65, 50}, 4), (Box{-8, -12, 263, 203}));
  EXPECT_EQ(scaledBox({7, 9, 7, 9}, 8), (Box{56, 72, 63, 79}));
  EXPECT_EQ(scaledBox({-5, -5, -1, -1}, 2), (Box{-10, -10, -1, -1}));
  EXPECT_EQ(scaledBox({-5, 3, 10, 12}, 1), (Box{-5, 3, 10, 12}));
}

TEST(Box, ScaledSizeIsTheScaledSize) {
  const Box scaled = scaledBox({-17, 5, 33, 91}, 16);
  EXPECT_EQ(scaled.width(), 51 * 16);
  EXPECT_EQ(scaled.height(), 87 * 16);
}

TEST(Box, RefusesWhatDoesNotFit) {
  const auto kLargest = std::numeric_limits<int32_t>::max();
  EXPECT_THROW(static_cast<void>(scaledBox({0, 0, kLargest, 10}, 2)), Error);
  EXPECT_THROW(static_cast<void>(scaledBox({-kLargest, 0, 0, 10}, 2)), Error);
  EXPECT_THROW(static_cast<void>(scaledBox({0, 0, 10, 10}, 0)), Error);
  EXPECT_EQ(scaledBox({0, 0, kLargest, 10}, 1).maxX, kLargest);
}

TEST(Box, FindsTheScale) {
  EXPECT_EQ(scaleBetween({0, 0, 63, 47}, {0, 0, 255, 191}), 4);
  EXPECT_EQ(scaleBetween({-8, -8, 55, 39}, {0, 0, 63, 47}), 1);
  EXPECT_THROW(static_cast<void>(scaleBetween({0, 0, 63, 47}, {0, 0, 255, 190})), Error);
  EXPECT_THROW(static_cast<void>(scaleBetween({0, 0, 63, 47}, {0, 0, 31, 23})), Error);
  EXPECT_THROW(static_cast<void>(scaleBetween({0, 0, 63, 47}, {0, 0, 63, 95})), Error);
  EXPECT_THROW(static_cast<void>(scaleBetween({0, 0, -1, -1}, {0, 0, 63, 95})), Error);
}

TEST(Box, PlacesACropInItsFrame) {
  Image crop(2, 1, 1);
  crop.pixels = {5.0F, 6.0F};
  const Image placed = placedInBox(crop, {1, 1, 2, 1}, {0, 0, 3, 2});
  EXPECT_EQ(placed.pixels, (std::vector<float>{0, 0, 0, 0, 0, 5, 6, 0, 0, 0, 0, 0}));
}

TEST(Box, CutsOverscanAway) {
  Image wide(4, 1, 2);
  wide.pixels = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(placedInBox(wide, {-1, 0, 2, 0}, {0, 0, 1, 0}).pixels, (std::vector<float>{3, 4, 5, 6}));
  EXPECT_EQ(placedInBox(wide, {-1, 0, 2, 0}, {10, 10, 10, 10}).pixels, (std::vector<float>{0, 0}));
  EXPECT_EQ(placedInBox(wide, {-1, 0, 2, 0}, {-1, 0, 2, 0}), wide);
  EXPECT_THROW(static_cast<void>(placedInBox(wide, {0, 0, 9, 9}, {0, 0, 1, 0})), Error);
}

}  // namespace
}  // namespace xrds
