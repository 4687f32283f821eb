#include "frames/window_cover.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/check.h"

namespace xrds {
namespace {

constexpr uint32_t kWindow = 8;

// From rows of text, '#' for a marked window.
WindowMask maskOf(const std::vector<std::string>& rows) {
  const auto height = static_cast<uint32_t>(rows.size()), width = static_cast<uint32_t>(rows[0].size());
  WindowMask mask({height * kWindow, width * kWindow}, kWindow, false);
  for (uint32_t r = 0; r < height; ++r)
    for (uint32_t c = 0; c < width; ++c) mask.at(r, c) = rows[r][c] == '#';
  return mask;
}

FrameShape shapeOf(const WindowMask& mask) { return {mask.rows * kWindow, mask.columns * kWindow}; }

std::vector<Tile> cover(const WindowMask& mask, FrameShape frame, uint32_t halo = 8) {
  const Rectangle all{0, 0, frame.width, frame.height};
  return coverWindows(mask, frame, {all, all}, kWindow, halo);
}

double costOf(std::span<const Tile> tiles) {
  double cost = 0;
  for (const Tile& tile : tiles) cost += kTilePixels + static_cast<double>(tile.crop.width) * tile.crop.height;
  return cost;
}

// Every sequence of cuts, without memory and without bounding boxes: the definition.
double cheapest(const WindowMask& mask, uint32_t top, uint32_t bottom, uint32_t left, uint32_t right, uint32_t halo) {
  bool any = false;
  for (uint32_t r = top; r < bottom; ++r)
    for (uint32_t c = left; c < right; ++c) any |= mask.at(r, c) != 0;
  if (!any) return 0;
  const auto side = [&](uint32_t first, uint32_t end, uint32_t count) {
    const int from = static_cast<int>(first * kWindow) - static_cast<int>(halo);
    return std::min(end * kWindow + halo, count * kWindow) - static_cast<double>(std::max(from, 0));
  };
  double best = kTilePixels + side(top, bottom, mask.rows) * side(left, right, mask.columns);
  for (uint32_t cut = top + 1; cut < bottom; ++cut)
    best = std::min(best, cheapest(mask, top, cut, left, right, halo) + cheapest(mask, cut, bottom, left, right, halo));
  for (uint32_t cut = left + 1; cut < right; ++cut)
    best = std::min(best, cheapest(mask, top, bottom, left, cut, halo) + cheapest(mask, top, bottom, cut, right, halo));
  return best;
}

TEST(WindowCover, IsEmptyWithoutMarksAndTheFrameWithAll) {
  const FrameShape frame{45, 77};
  EXPECT_TRUE(cover(WindowMask(frame, kWindow, false), frame, 8).empty());
  const Rectangle whole{0, 0, 77, 45};
  EXPECT_EQ(cover(WindowMask(frame, kWindow, true), frame, 8), (std::vector<Tile>{{whole, whole}}));
}

TEST(WindowCover, TakesTheFrameInOnePieceWhereLittleIsSaved) {
  WindowMask mask(FrameShape{160, 160}, kWindow, true);
  mask.at(7, 9) = mask.at(0, 0) = 0;
  const auto tiles = cover(mask, {160, 160}, 8);
  ASSERT_EQ(tiles.size(), 1U);
  EXPECT_EQ(tiles[0].crop, (Rectangle{0, 0, 160, 160}));
}

TEST(WindowCover, CutsOffASky) {
  WindowMask mask(FrameShape{128, 203}, kWindow, true);
  for (uint32_t row = 0; row < 8; ++row)
    for (uint32_t column = 0; column < mask.columns; ++column) mask.at(row, column) = 0;
  const auto tiles = cover(mask, {128, 203}, 16);
  ASSERT_EQ(tiles.size(), 1U);
  EXPECT_EQ(tiles[0].inner, (Rectangle{0, 64, 203, 64}));
  EXPECT_EQ(tiles[0].crop, (Rectangle{0, 48, 203, 80}));
}

TEST(WindowCover, IsTheCheapestThatCutsReach) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 30; ++trial) {
    // Blots of marks: corners, bars and single windows all occur.
    WindowMask mask(FrameShape{5 * kWindow, 7 * kWindow}, kWindow, false);
    for (int blot = 0; blot < 3; ++blot) {
      const uint32_t top = random() % 5, left = random() % 7;
      for (uint32_t r = top; r < std::min<uint32_t>(5, top + 1 + random() % 3); ++r)
        for (uint32_t c = left; c < std::min<uint32_t>(7, left + 1 + random() % 3); ++c) mask.at(r, c) = 1;
    }
    const FrameShape frame = shapeOf(mask);
    const double whole = kTilePixels + static_cast<double>(frame.width) * frame.height;
    const double best = cheapest(mask, 0, 5, 0, 7, 8);
    const double found = costOf(cover(mask, frame, 8));
    EXPECT_DOUBLE_EQ(found, best > 0.95 * whole ? whole : best) << trial;
  }
}

TEST(WindowCover, CoversEveryMarkOnceOnLargeGrids) {
  std::mt19937 random(3);
  for (const auto& [rows, columns, share] : {std::tuple(33u, 61u, 40u), {90u, 47u, 8u}, {21u, 20u, 3u}}) {
    const FrameShape frame{rows * kWindow - 3, columns * kWindow - 5};
    WindowMask mask(frame, kWindow, false);
    for (uint32_t row = rows / 3; row < rows; ++row)
      for (uint32_t column = 0; column < columns / 2; ++column) mask.at(row, column) = random() % 100 < share;
    const auto tiles = cover(mask, frame, 8);
    WindowMask times(frame, kWindow, false);
    for (const Tile& tile : tiles) {
      EXPECT_EQ(tile.inner.x % kWindow + tile.inner.y % kWindow + tile.crop.x % kWindow + tile.crop.y % kWindow, 0U);
      EXPECT_LE(tile.crop.x + tile.crop.width, frame.width);
      EXPECT_LE(tile.crop.y + tile.crop.height, frame.height);
      const uint32_t left = static_cast<uint32_t>(tile.inner.x);
      for (uint32_t row = tile.inner.y / kWindow; row * kWindow < tile.inner.y + tile.inner.height; ++row)
        for (uint32_t c = left / kWindow; c * kWindow < left + tile.inner.width; ++c) ++times.at(row, c);
    }
    for (size_t i = 0; i < mask.marks.size(); ++i) {
      EXPECT_LE(times.marks[i], 1);
      EXPECT_LE(mask.marks[i], times.marks[i]);
    }
    const WindowMask outside = windowsOutside(tiles, frame, kWindow);
    for (size_t i = 0; i < mask.marks.size(); ++i) EXPECT_EQ(outside.marks[i], 1 - times.marks[i]);
  }
}

TEST(WindowCover, SplitsTwoFarObjects) {
  const WindowMask mask = maskOf({"##..........", "##..........", "............", "............", "............",
                                  "............", "............", "..........##", "..........##"});
  EXPECT_EQ(cover(mask, shapeOf(mask), 8).size(), 2U);
}

TEST(WindowCover, StaysWithinTheTileThatItCutsDown) {
  WindowMask mask(FrameShape{160, 160}, kWindow, true);
  for (uint32_t column = 0; column < 9; ++column)
    for (uint32_t row = 0; row < 20; ++row) mask.at(row, column) = 0;
  const Tile grid[] = {{{0, 0, 160, 88}, {0, 0, 160, 80}}, {{0, 72, 160, 88}, {0, 80, 160, 80}}};
  const auto lower = coverWindows(mask, {160, 160}, grid[1], kWindow, 8);
  EXPECT_EQ(lower, (std::vector<Tile>{{{64, 72, 96, 88}, {72, 80, 88, 80}}}));
  mask.marks.assign(mask.marks.size(), 1);
  EXPECT_EQ(coverWindows(mask, {160, 160}, grid[0], kWindow, 8), (std::vector<Tile>{grid[0]}));
  mask.marks.assign(mask.marks.size(), 0);
  EXPECT_TRUE(coverWindows(mask, {160, 160}, grid[0], kWindow, 8).empty());
}

TEST(WindowCover, RefusesAHaloOfHalfAWindow) {
  EXPECT_THROW(cover(WindowMask({16, 16}, kWindow, true), {16, 16}, 4), std::logic_error);
}

}  // namespace
}  // namespace xrds
