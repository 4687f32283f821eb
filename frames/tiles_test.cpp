// How frames are cut into tiles, how far the network sees, and which tiles fit a memory: pure questions.
#include "frames/tiles.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "frames/tile_choice.h"
#include "network/halo.h"
#include "tests/print_case.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using test::PrintTo;  // NOLINT(misc-unused-using-decls): GoogleTest calls it

struct Case {
  FrameShape frame;
  uint32_t window;
  Cut cut;
};

class CutFrame : public testing::TestWithParam<Case> {};

TEST_P(CutFrame, CoversTheFrameOnceWithHalos) {
  const auto& [frame, window, cut] = GetParam();
  const auto tiles = cutFrame(frame, window, cut);
  std::vector<int> covered(size_t{frame.width} * frame.height);
  const auto width = static_cast<int32_t>(frame.width), halo = static_cast<int32_t>(cut.halo);
  for (const auto& [crop, inner] : tiles) {
    for (uint32_t y = inner.y; y < inner.y + inner.height; ++y)
      for (uint32_t x = 0; x < inner.width; ++x) ++covered.at(size_t{y} * frame.width + inner.x + x);
    EXPECT_EQ(crop.x % static_cast<int32_t>(window), 0);
    EXPECT_EQ(crop.y % window, 0u);
    EXPECT_EQ(inner.x % static_cast<int32_t>(window), 0);
    EXPECT_EQ(inner.y % window, 0u);
    const int32_t right = inner.x + static_cast<int32_t>(inner.width),
                  cropRight = crop.x + static_cast<int32_t>(crop.width);
    const uint32_t bottom = inner.y + inner.height, cropBottom = crop.y + crop.height;
    EXPECT_LE(crop.x, cut.wrap ? inner.x - halo : std::max(0, inner.x - halo));
    EXPECT_GE(cropRight, cut.wrap ? right + halo : std::min(width, right + halo));
    EXPECT_LE(crop.y, inner.y - std::min(inner.y, cut.halo));
    EXPECT_GE(cropBottom, std::min(frame.height, bottom + cut.halo));
    if (!cut.wrap) {
      EXPECT_TRUE(crop.x >= 0 && cropRight <= width);
      EXPECT_TRUE(cropRight == width || cropRight % static_cast<int32_t>(window) == 0);
      EXPECT_LT(tiles.front().crop.width - crop.width, window);
    }
    EXPECT_TRUE(cropBottom == frame.height || (cropBottom < frame.height && cropBottom % window == 0));
    EXPECT_LT(tiles.front().crop.height - crop.height, window);
  }
  EXPECT_EQ(std::count(covered.begin(), covered.end(), 1), static_cast<int64_t>(covered.size()));
}

INSTANTIATE_TEST_SUITE_P(Tiles, CutFrame,
                         testing::Values(Case{{1, 1}, 8, {1, 1, 8}}, Case{{64, 64}, 8, {1, 1, 0}},
                                         Case{{64, 64}, 8, {4, 4, 0}}, Case{{270, 480}, 8, {3, 2, 16}},
                                         Case{{271, 483}, 8, {3, 5, 24}}, Case{{33, 40}, 8, {9, 9, 8}},
                                         Case{{39, 41}, 8, {100, 100, 8}}, Case{{39, 41}, 8, {3, 3, 64}},
                                         Case{{77, 59}, 4, {7, 6, 4}}, Case{{40, 64}, 8, {1, 1, 16, true}},
                                         Case{{40, 64}, 8, {3, 2, 16, true}}, Case{{40, 61}, 8, {2, 2, 64, true}},
                                         Case{{9, 5}, 4, {4, 4, 4, true}}));

TEST(CutFrame, RefusesAHaloOfPartsOfWindows) { EXPECT_THROW(cutFrame({64, 64}, 8, {2, 2, 12}), std::logic_error); }

// Counted by hand along the forward pass, in the notes behind each.
TEST(ExactHalo, FollowsTheForwardPass) {
  const NetworkConfig nano{.channels = 16, .auxChannels = 8, .groups = 1, .blocks = 1, .headChannels = 16};
  // lr_conv 1, conv 2, XM 8, STL 8, shifted 12, 16, conv 17, conv 18, fuse, body, up_pre 21; from there on by fours:
  // up.0 24, up.1 2 * 24 + 4, out 2 * 52 + 4 = 108 pixels of the output, 27 of the colour
  EXPECT_EQ(exactHalo(nano), 32u);
  // lr_conv 1; group 1: 2, 8, 8, 12, 16, 17, 18; 2: 19, 24, 24, 28, 32, 33, 34; 3: 35, 40, 40, 44, 48, 49, 50; 53 in
  // front of the doublings, 56, 116, 236 output pixels, 59; the base reads two more: 61
  EXPECT_EQ(exactHalo({.channels = 32, .blocks = 1, .kernels = 5, .auxSkip = true, .auxKernels = 5}), 64u);
  // No window. aux_conv 4, deshuffle.0 4, the group's aux_conv 5, three convolutions 8, 9; 12 in front of the doubling,
  // 16, 36 output pixels, 18
  EXPECT_EQ(exactHalo({.scale = 2, .groups = 1, .blocks = 1, .block = BlockKind::rdb, .cross = CrossKind::concat}),
            24u);
  // Windows that do not begin at multiples of four pixels, so no fours: aux_conv 1, deshuffle.0 2, 3, three
  // convolutions 6, 7; 10 in front of the doubling, 22, 23 output pixels, 12
  EXPECT_EQ(
      exactHalo(
          {.scale = 2, .groups = 1, .blocks = 1, .window = 6, .block = BlockKind::rdb, .cross = CrossKind::concat}),
      12u);
  // No network: the base image reads two pixels
  EXPECT_EQ(exactHalo({.groups = 0}), 8u);
  EXPECT_EQ(boundedHalo({.groups = 0}), 8u);
  EXPECT_EQ(boundedHalo(nano), 16u);
}

const NetworkConfig kSmall{.channels = 16, .auxChannels = 8, .groups = 1, .blocks = 1, .headChannels = 16};

TileChoice choiceOf(Cut wanted, const MemoryLimits& limits, FrameShape frame = {500, 700}) {
  if (wanted.halo == 0) wanted.halo = 16;
  return chooseTiles(NetworkModel::random(kSmall, 1), frame, Precision::fp32, wanted, limits);
}

constexpr Cut kAnyGrid{0, 0};

TEST(ChooseTiles, TakesTheFrameWholeIfItFits) {
  const TileChoice choice = choiceOf(kAnyGrid, {uint64_t{1} << 31}, {200, 300});
  EXPECT_EQ(choice.cut.columns * choice.cut.rows, 1u);
  EXPECT_EQ(choice.crop.width, 300u);
  EXPECT_EQ(choice.crop.height, 200u);
  EXPECT_EQ(choice.work, 1);
}

TEST(ChooseTiles, UsesTheMemoryItMay) {
  double work = 1;
  for (const uint64_t megabytes : {128, 64, 32, 16}) {
    const TileChoice choice = choiceOf(kAnyGrid, {megabytes * 1'000'000});
    EXPECT_LE(choice.arenaByteSize + choice.weightByteSize, megabytes * 1'000'000);
    EXPECT_GT(choice.arenaByteSize + choice.weightByteSize, megabytes * 700'000);
    EXPECT_GT(choice.work, work);
    work = choice.work;
    const auto tiles = cutFrame({500, 700}, kSmall.window, choice.cut);
    EXPECT_EQ(tiles.size(), choice.cut.columns * choice.cut.rows);
    uint64_t pixels = 0;
    for (const Tile& tile : tiles) {
      EXPECT_TRUE(tile.crop.width <= choice.crop.width && tile.crop.height <= choice.crop.height);
      pixels += uint64_t{tile.crop.width} * tile.crop.height;
    }
    EXPECT_DOUBLE_EQ(choice.work, static_cast<double>(pixels) / (500 * 700));
  }
}

TEST(ChooseTiles, KeepsToTheLimitsOfTheDevice) {
  MemoryLimits limits{uint64_t{1} << 40};
  limits.traits.maxTexelBufferElements = 300'000;
  const TileChoice texels = choiceOf(kAnyGrid, limits);
  EXPECT_GT(texels.cut.columns * texels.cut.rows, 20u);
  limits.traits = {.maxAllocationBytes = 20'000'000};
  EXPECT_LE(choiceOf(kAnyGrid, limits).arenaByteSize, 20'000'000u);
  const TileChoice wide = choiceOf({.columns = 0, .rows = 1}, {uint64_t{1} << 50}, {8, 100'000});
  EXPECT_GT(wide.cut.columns, 6u);  // a graph is at most 65536 pixels wide
  EXPECT_LT(wide.cut.columns, 10u);
}

TEST(ChooseTiles, TakesTheGridThatIsGiven) {
  const TileChoice choice = choiceOf({3, 2}, {uint64_t{1} << 31});
  EXPECT_EQ(choice.cut.columns, 3u);
  EXPECT_EQ(choice.cut.rows, 2u);
  EXPECT_THROW(choiceOf({3, 2}, {10'000'000}), Error);
}

const Cut kExact{0, 0, exactHalo(kSmall)}, kBounded{0, 0, boundedHalo(kSmall)};

std::string errorOf(const Cut& wanted, const MemoryLimits& limits) {
  try {
    choiceOf(wanted, limits);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(ChooseTiles, SaysWhatIsNeededAtLeast) {
  const std::string exact = errorOf(kExact, {1'000'000}), bounded = errorOf(kBounded, {1'000'000});
  EXPECT_NE(exact.find("1 MB are allowed: allow more, or take fp16, bounded tiles, or"), std::string::npos) << exact;
  EXPECT_NE(bounded.find("1 MB are allowed: allow more, or take fp16, or"), std::string::npos) << bounded;
}

TEST(ChooseTiles, SaysThatTheDeviceBindsTooLittle) {
  MemoryLimits limits{uint64_t{1} << 40};
  limits.traits.maxTexelBufferElements = 3'000;
  const std::string exact = errorOf(kExact, limits), bounded = errorOf(kBounded, limits);
  EXPECT_NE(exact.find("binds at most 3000: take bounded tiles, a smaller"), std::string::npos) << exact;
  EXPECT_NE(bounded.find("binds at most 3000: take a smaller"), std::string::npos) << bounded;
}

}  // namespace
}  // namespace xrds
