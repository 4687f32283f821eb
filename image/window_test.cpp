#include "image/window.h"

#include <gtest/gtest.h>

#include <limits>

#include "xrds/error.h"

namespace xrds {
namespace {

TEST(Window, ScalesExactly) {
  EXPECT_EQ(scaledWindow({0, 0, 63, 47}, 4), (Window{0, 0, 255, 191}));
  EXPECT_EQ(scaledWindow({-2, -3, 65, 50}, 4), (Window{-8, -12, 263, 203}));
  EXPECT_EQ(scaledWindow({7, 9, 7, 9}, 8), (Window{56, 72, 63, 79}));
  EXPECT_EQ(scaledWindow({-5, -5, -1, -1}, 2), (Window{-10, -10, -1, -1}));
  EXPECT_EQ(scaledWindow({-5, 3, 10, 12}, 1), (Window{-5, 3, 10, 12}));
}

TEST(Window, ScaledSizeIsTheScaledSize) {
  const Window scaled = scaledWindow({-17, 5, 33, 91}, 16);
  EXPECT_EQ(scaled.width(), 51 * 16);
  EXPECT_EQ(scaled.height(), 87 * 16);
}

TEST(Window, RefusesWhatDoesNotFit) {
  const auto kLargest = std::numeric_limits<int32_t>::max();
  EXPECT_THROW(static_cast<void>(scaledWindow({0, 0, kLargest, 10}, 2)), Error);
  EXPECT_THROW(static_cast<void>(scaledWindow({-kLargest, 0, 0, 10}, 2)), Error);
  EXPECT_THROW(static_cast<void>(scaledWindow({0, 0, 10, 10}, 0)), Error);
  EXPECT_EQ(scaledWindow({0, 0, kLargest, 10}, 1).maxX, kLargest);
}

TEST(Window, FindsTheScale) {
  EXPECT_EQ(scaleBetween({0, 0, 63, 47}, {0, 0, 255, 191}), 4);
  EXPECT_EQ(scaleBetween({-8, -8, 55, 39}, {0, 0, 63, 47}), 1);
  EXPECT_THROW(static_cast<void>(scaleBetween({0, 0, 63, 47}, {0, 0, 255, 190})), Error);
  EXPECT_THROW(static_cast<void>(scaleBetween({0, 0, 63, 47}, {0, 0, 31, 23})), Error);
  EXPECT_THROW(static_cast<void>(scaleBetween({0, 0, 63, 47}, {0, 0, 63, 95})), Error);
  EXPECT_THROW(static_cast<void>(scaleBetween({0, 0, -1, -1}, {0, 0, 63, 95})), Error);
}

TEST(Window, PlacesACropInItsFrame) {
  Image crop(2, 1, 1);
  crop.pixels = {5.0F, 6.0F};
  const Image placed = placedInWindow(crop, {1, 1, 2, 1}, {0, 0, 3, 2});
  EXPECT_EQ(placed.pixels, (std::vector<float>{0, 0, 0, 0, 0, 5, 6, 0, 0, 0, 0, 0}));
}

TEST(Window, CutsOverscanAway) {
  Image wide(4, 1, 2);
  wide.pixels = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(placedInWindow(wide, {-1, 0, 2, 0}, {0, 0, 1, 0}).pixels, (std::vector<float>{3, 4, 5, 6}));
  EXPECT_EQ(placedInWindow(wide, {-1, 0, 2, 0}, {10, 10, 10, 10}).pixels, (std::vector<float>{0, 0}));
  EXPECT_EQ(placedInWindow(wide, {-1, 0, 2, 0}, {-1, 0, 2, 0}), wide);
  EXPECT_THROW(static_cast<void>(placedInWindow(wide, {0, 0, 9, 9}, {0, 0, 1, 0})), Error);
}

}  // namespace
}  // namespace xrds
