#include "shaders/winograd_products/winograd_products.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::winograd_products_test {
namespace {

using test::PrintTo;
using test::view;

struct Case {
  uint32_t height, width, inputs, outputs;  // of squares
  RowRange rows{};
  bool shuffled = false;
  uint32_t firstOutput = 0, outputsOfWeight = 0;  // 0: as many as there are
  uint32_t firstInputs = 0;
};

// One square, channels of padding, tiles of four, rows of a band, parts of a shuffle, more than a workgroup's squares,
// the widths of networks, inputs in two groups.
constexpr Case kCases[] = {{1, 1, 4, 4},
                           {3, 5, 6, 7},
                           {2, 9, 12, 20},
                           {5, 7, 16, 48, {1, 4}},
                           {4, 9, 32, 64, {}, true},
                           {2, 9, 8, 16, {}, true, 4, 32},
                           {2, 9, 8, 16, {}, false, 16, 40},
                           {9, 67, 64, 64},
                           {3, 11, 60, 60, {1, 2}},
                           {2, 5, 180, 36},
                           {1, 3, 256, 32},
                           {2, 9, 14, 8, {}, false, 0, 0, 12},
                           {3, 7, 76, 64, {1, 3}, false, 0, 0, 64}};

uint32_t outputsOfWeight(const Case& c) { return c.outputsOfWeight > 0 ? c.outputsOfWeight : c.outputs; }

WinogradProducts productsOf(const Case& c, std::span<const float> weight) {
  const uint32_t inputs = 36 * alignUp(c.inputs, 4), outputs = 36 * alignUp(c.outputs, 4);
  return {.input = view(0, DataType::f32, c.height, c.width, inputs, 4, inputs + 16),
          .output = view(1, DataType::f32, c.height, c.width, outputs, 8, outputs + 16),
          .firstInputs = c.firstInputs,
          .weight = weight,
          .inputChannels = c.inputs,
          .outputChannels = outputsOfWeight(c),
          .firstOutput = c.firstOutput,
          .shuffled = c.shuffled,
          .rows = c.rows};
}

class WinogradProductsCases : public testing::TestWithParam<std::tuple<Case, KernelFamily>> {};

TEST_P(WinogradProductsCases, MatchesReference) {
  const auto& [c, family] = GetParam();
  const auto weight = test::randomNumbers(size_t{outputsOfWeight(c)} * c.inputs * 9, 1);
  test::expectMatchesReference(productsOf(c, weight), test::traitsOf(family), toleranceOf(DataType::f32));
  if (family == KernelFamily::lane) test::expectMatchesReferenceByAddress(productsOf(c, weight), c.inputs <= 16);
  if (family != KernelFamily::lane || c.outputs < 20 || c.inputs > 64) return;
  DeviceTraits inTurns = test::traitsOf(family);
  inTurns.shape.rows = 2;
  test::expectMatchesReference(productsOf(c, weight), inTurns, toleranceOf(DataType::f32));
}

INSTANTIATE_TEST_SUITE_P(All, WinogradProductsCases,
                         testing::Combine(testing::ValuesIn(kCases),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane)));

// The weight at the centre alone: plane (0, 0) stands for the corner of the weights, which is zero.
TEST(WinogradProducts, OfOneTapHasNoCorners) {
  std::vector<float> weight(4 * 4 * 9);
  weight[4] = 1;
  const WinogradProducts op = productsOf({1, 1, 4, 4}, weight);
  HostMemory memory;
  for (uint32_t i = 0; i < 144; ++i) memory.at(op.input, 0, 0, i) = 1;
  reference(op, memory);
  EXPECT_EQ(memory.at(op.output, 0, 0, 0), 0);
  const double expected = 1.5 * 1.5 / 4 / (5.0625 - 1) / (5.0625 - 1);
  EXPECT_NEAR(memory.at(op.output, 0, 0, 4 * 7), expected, 1e-9);   // plane (1, 1), output 0
  EXPECT_NEAR(memory.at(op.output, 0, 0, 4 * 8), -expected, 1e-9);  // plane (1, 2)
  EXPECT_EQ(memory.at(op.output, 0, 0, 4 * 7 + 1), 0);              // output 1
}

TEST(WinogradProducts, SavesThreeQuartersOfTheProducts) {
  const std::vector<float> weight(16 * 8 * 9);
  const WinogradProducts op = productsOf({3, 5, 8, 16}, weight);
  DeviceTraits traits = test::traitsOf(KernelFamily::lane);
  traits.laneCode = LaneCode::shuffles;
  const Dispatch launch = dispatch(op, traits);
  EXPECT_EQ(launch.program, "winograd_products_lane_f32");
  EXPECT_EQ(launch.multiplyAdds, 3u * 5 * 16 * 9 * 8 * 16);
  EXPECT_EQ(launch.savedProducts, launch.multiplyAdds / 4 * 3);
}

TEST(WinogradProducts, ReadsWeightsByAddressInOneTile) {
  const std::vector<float> weight(16 * 128 * 9);
  const Dispatch launch = dispatch(
      productsOf({3, 5, 16, 128}, weight),
      {.family = KernelFamily::lane, .shaderInt64 = true, .laneCode = LaneCode::scalars, .bufferAddresses = true});
  EXPECT_EQ(launch.program, "winograd_products_lane_f32_addressed");
  EXPECT_TRUE(launch.weightsByAddress);
  EXPECT_EQ(launch.groupCount[0], 36u);
}

TEST(WinogradProducts, TakesTurnsOnVectorsOf256Bits) {
  const std::vector<float> weight(size_t{160} * 64 * 9);
  const auto takesTurns = [&](uint32_t inputs, uint32_t outputs, DeviceTraits device) {
    device.family = KernelFamily::lane;
    device.shaderInt64 = true;
    const std::span<const float> used = std::span(weight).first(size_t{inputs} * outputs * 9);
    return dispatch(productsOf({3, 5, inputs, outputs}, used), device).specialization[6] == 1;
  };
  EXPECT_TRUE(takesTurns(64, 64, {.subgroupSize = 8}));
  EXPECT_FALSE(takesTurns(64, 64, {.subgroupSize = 16}));
  EXPECT_FALSE(takesTurns(64, 8, {.subgroupSize = 8})) << "eight outputs are one turn";
  EXPECT_FALSE(takesTurns(160, 32, {.subgroupSize = 8})) << "the squares leave a second-level cache of 512 KiB";
  EXPECT_TRUE(takesTurns(128, 32, {.subgroupSize = 8, .secondCacheBytes = uint64_t{1} << 20}));
  EXPECT_FALSE(takesTurns(64, 64, {.subgroupSize = 8, .laneCode = LaneCode::broadcasts}));
  EXPECT_TRUE(takesTurns(64, 64, {.shape = {.rows = 2}, .subgroupSize = 16}));
  EXPECT_FALSE(takesTurns(64, 64, {.shape = {.rows = 1}, .subgroupSize = 8}));
}

TEST(WinogradProducts, RefusesWhatDoesNotFit) {
  const std::vector<float> weight(8 * 8 * 9);
  const WinogradProducts op = productsOf({2, 2, 8, 8}, weight);
  EXPECT_NO_THROW(dispatch(op, {}));
  WinogradProducts wrong = op;
  wrong.inputChannels = 4;
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong = op;
  wrong.firstInputs = 12;
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong = op;
  wrong.output.channels = 40;
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::winograd_products_test
