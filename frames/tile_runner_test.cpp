// Tiles with the exact halo give the picture of the whole frame bit for bit.
#include "frames/tile_runner.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "checks/stress/edges.h"
#include "network/halo.h"
#include "network/oidn.h"
#include "tests/harness.h"
#include "tests/noise_frame.h"
#include "tests/print_case.h"

namespace xrds {
namespace {

struct Frame : test::NoiseFrame {
  using NoiseFrame::NoiseFrame;
  bool run(TileRunner& runner, const Cut& cut, const NetworkConfig& config, std::optional<float> exposure = {},
           const std::function<bool(double)>& progress = {}) {
    return runner.run(input(exposure), cutFrame(frame, config.window, cut), output, progress);
  }
};

// Those of the stress run, in which every scale, kind of block, way to join, filter and full-resolution stage occurs;
// then a window of 8 pixels, no network, and the other architectures whose tiles are exact.
std::vector<NetworkConfig> tiledConfigs() {
  NetworkConfig narrow = stressConfig("full");
  narrow.groups = 1;
  NetworkConfig wide = narrow;
  wide.scale = 4;
  wide.blocks = 1;
  wide.window = 8;
  wide.auxKernels = 0;
  std::vector<NetworkConfig> all{narrow, wide};
  for (const char* name : {"dense", "plain", "bare"}) all.push_back(stressConfig(name));
  all.push_back({.scale = 4, .groups = 0});
  all.push_back(stressConfig("merged"));
  for (const StressNetwork& network : stressNetworks())
    if (network.config.architecture != NetworkConfig{}.architecture && !seesWholeFrame(network.config))
      all.push_back(network.config);
  return all;
}
const std::vector<NetworkConfig> kConfigs = tiledConfigs();

/// Runs a test in a kernel family.
struct InFamily {
  explicit InFamily(KernelFamily family) : before(test::gpu().traits()) {
    DeviceTraits traits = before;
    traits.family = family;
    test::gpu().setTraits(traits);
  }
  ~InFamily() { test::gpu().setTraits(before); }
  DeviceTraits before;
};

class ExactTiles : public testing::TestWithParam<std::tuple<Precision, KernelFamily>> {};

void expectTilesEqualTheWhole(const NetworkConfig& config, Precision precision) {
  const NetworkModel model = NetworkModel::random(config, 3);
  const uint32_t halo = exactHalo(config);
  TileRunner runner(test::gpu(), model, {.precision = precision});
  const FrameShape shape{2 * halo + config.window + 3, 2 * halo + 3 * config.window + 5};
  Frame frame(config, shape);
  std::vector<float> expected(frame.output.size());
  Session whole(test::gpu(), model, shape, {.precision = precision});
  const std::optional<float> exposure = takesBinnedExposure(config) ? std::optional(0.5f) : std::nullopt;
  ASSERT_TRUE(whole.run(frame.input(exposure), expected));
  const Cut cut{2, 2, halo};
  ASSERT_EQ(cutFrame(shape, config.window, cut).size(), 4u);
  ASSERT_TRUE(frame.run(runner, cut, config, exposure));
  EXPECT_EQ(frame.output, expected);
  EXPECT_EQ(runner.exposure(), whole.exposure());
}

TEST_P(ExactTiles, EqualTheWholeFrameBitForBit) {
  const auto [precision, kernels] = GetParam();
  const InFamily family(kernels);
  // The first two have every operator; the others differ in how they are joined.
  const size_t count = precision == Precision::fp16 ? 2 : std::size(kConfigs);
  for (size_t i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    expectTilesEqualTheWhole(kConfigs[i], precision);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ExactTiles,
                         testing::Combine(testing::Values(Precision::fp32, Precision::fp16),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane)));

// A window less shows, so the halo is as small as can be.
// Where sums are fused, rounding takes away the little that the outermost window of one of these networks adds.
TEST(TileRunner, ASmallerHaloIsNotExact) {
  int inexact = 0;
  for (const size_t which : {1, 2, 5}) {
    const NetworkConfig& config = kConfigs[which];
    const NetworkModel model = NetworkModel::random(config, 3);
    const uint32_t halo = exactHalo(config);
    Frame frame(config, {config.window, 4 * halo + 22});
    TileRunner runner(test::gpu(), model, {});
    ASSERT_TRUE(frame.run(runner, {1, 1, 0}, config));
    const std::vector<float> whole = frame.output;
    ASSERT_TRUE(frame.run(runner, {2, 1, halo - config.window}, config));
    inexact += frame.output != whole;
  }
  const bool fuses =
      test::gpu().traits().laneCode == LaneCode::scalars || test::gpu().description().kind != DeviceKind::cpu;
  EXPECT_GE(inexact, fuses ? 2 : 3);
}

TEST(TileRunner, AWrappedFrameHasNoBeginning) {
  const NetworkConfig& config = kConfigs[1];
  const NetworkModel model = NetworkModel::random(config, 3);
  const uint32_t halo = exactHalo(config), roll = 3 * config.window;
  const FrameShape shape{20, 9 * config.window};
  Frame frame(config, shape), rolled(config, shape, roll);
  TileRunner runner(test::gpu(), model, {});
  ASSERT_TRUE(frame.run(runner, {1, 1, halo, true}, config, 0.5f));
  const size_t width = size_t{shape.width} * config.scale;
  for (const uint32_t columns : {1u, 2u, 4u}) {
    ASSERT_TRUE(rolled.run(runner, {columns, 1, halo, true}, config, 0.5f));
    size_t differing = 0;
    for (size_t i = 0; i < frame.output.size() / 3; ++i) {
      const size_t to = i / width * width + (i % width + size_t{roll} * config.scale) % width;
      for (size_t c = 0; c < 3; ++c) differing += frame.output[3 * i + c] != rolled.output[3 * to + c];
    }
    EXPECT_EQ(differing, 0u) << columns;
  }
  const std::vector<float> wrapped = frame.output;
  ASSERT_TRUE(frame.run(runner, {1, 1, 0}, config, 0.5f));
  EXPECT_NE(frame.output, wrapped);
}

// Tiles that are given need no grid: two rectangles of different size, the rest of the output stays.
TEST(TileRunner, RunsAnyTilesAndLeavesTheRest) {
  const NetworkConfig& config = kConfigs[2];
  const NetworkModel model = NetworkModel::random(config, 3);
  Frame frame(config, {60, 64});
  TileRunner runner(test::gpu(), model, {});
  ASSERT_TRUE(frame.run(runner, {1, 1, 0}, config));
  const std::vector<float> whole = frame.output;
  const uint32_t halo = exactHalo(config);
  const std::vector<Tile> tiles{{{0, 0, 8 + halo, 12 + halo}, {0, 0, 8, 12}},
                                {{24 - static_cast<int32_t>(halo), 0, 12 + 2 * halo, 60}, {24, 40, 12, 20}}};
  std::fill(frame.output.begin(), frame.output.end(), -1.f);
  ASSERT_TRUE(runner.run(frame.input(), tiles, frame.output));
  for (size_t y = 0; y < 240; ++y)
    for (size_t x = 0; x < 256; ++x) {
      const bool inFirst = x < 32 && y < 48, inSecond = x >= 96 && x < 144 && y >= 160;
      const size_t i = 3 * (y * 256 + x);
      ASSERT_EQ(frame.output[i], inFirst || inSecond ? whole[i] : -1.f) << x << ", " << y;
    }
}

TEST(TileRunner, SessionsShareTheMemoryOfTheLargest) {
  const NetworkConfig& config = kConfigs[1];
  const NetworkModel model = NetworkModel::random(config, 3);
  TileRunner runner(test::gpu(), model, {});
  const auto tiles = cutFrame({101, 109}, config.window, {2, 2, 24});
  runner.prepare(tiles);
  const Session largest(test::gpu(), model, {tiles[0].crop.height, tiles[0].crop.width}, {.autoExposure = false});
  EXPECT_EQ(runner.byteSize(), largest.ownByteSize());
}

TEST(TileRunner, ReportsProgressWithinTilesAndStops) {
  const NetworkConfig& config = kConfigs[1];
  const NetworkModel model = NetworkModel::random(config, 3);
  Frame frame(config, {40, 120});
  TileRunner runner(test::gpu(), model, {});
  std::vector<double> shares;
  const auto collect = [&](double share) {
    shares.push_back(share);
    return true;
  };
  ASSERT_TRUE(frame.run(runner, {3, 1, 8}, config, {}, collect));
  EXPECT_GE(shares.size(), 3u);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_DOUBLE_EQ(shares.back(), 1);
  size_t calls = 0;
  EXPECT_FALSE(frame.run(runner, {3, 1, 8}, config, {}, [&](double) { return ++calls < 2; }));
  EXPECT_EQ(calls, 2u);
}

TEST(TileRunner, MeasuresTheExposureOnTheHostWhereTheDeviceHasNoRoom) {
  const Frame frame({.auxInputs = {}, .base = BaseImage::bicubic}, {30, 41});
  Buffer small(test::gpu(), 256), large(test::gpu(), 64 * 1024);
  const PixelView colour = frame.view(frame.colour, 1);
  const FrameExposure host = exposureOf(test::gpu(), colour, small), device = exposureOf(test::gpu(), colour, large);
  EXPECT_NEAR(host.value, device.value, 1e-5 * host.value);
  EXPECT_NEAR(host.value * host.inverse, 1, 1e-6);
}

}  // namespace
}  // namespace xrds
