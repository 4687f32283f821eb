#include "shaders/swin_layer/swin_layer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::swin_layer_test {
namespace {

using test::PrintTo;
using test::view;

struct Case {
  uint32_t height, width, channels, headChannels, hidden, grown;  // 0: no convolution behind the layer
  uint32_t shift = 0;
  uint32_t inputOffset = 0, inputStride = 0, outputOffset = 0, outputStride = 0;
  RowRange rows{};
};

// One window, then the widths of the shipped networks and of the paper (of which the wider ones ask for 48 KiB of
// shared memory), slices of a dense block, the wrapped windows of a shift, and rows that are parts of windows.
constexpr Case kCases[] = {{8, 8, 16, 16, 32, 0},
                           {16, 24, 16, 16, 32, 16, 4, 0, 48, 16, 48},
                           {16, 8, 32, 16, 64, 16, 0, 4, 40, 8, 32},
                           {8, 16, 48, 16, 96, 16, 4},
                           {16, 16, 32, 32, 64, 0, 4},
                           {24, 16, 64, 32, 128, 32, 4, 0, 96, 64, 96, {4, 20}},
                           {24, 16, 64, 32, 128, 64, 4, 0, 0, 0, 0, {3, 13}},
                           {16, 16, 96, 32, 192, 32, 4},
                           {16, 16, 128, 32, 256, 64, 4, 0, 192, 128, 192},
                           {16, 8, 192, 32, 384, 64, 4}};

/// A layer of random weights, which live as long as it.
struct RandomLayer {
  std::deque<std::vector<float>> numbers;
  SwinLayer op;

  explicit RandomLayer(const Case& c) {
    const uint32_t grown = c.grown ? c.grown : c.channels;
    op.input = view(0, DataType::f16, c.height, c.width, c.channels, c.inputOffset, c.inputStride);
    op.output = view(1, DataType::f16, c.height, c.width, grown, c.outputOffset, c.outputStride);
    op.norm1 = map(c.channels, 1);
    op.norm2 = map(c.channels, 1);
    op.qkv = map(3 * c.channels, c.channels);
    op.proj = map(c.channels, c.channels);
    op.fc1 = map(c.hidden, c.channels);
    op.fc2 = map(c.channels, c.hidden);
    if (c.grown) op.grow = map(c.grown, c.channels);
    op.biasTable = random(15 * 15 * (c.channels / c.headChannels), 2);
    op.headChannels = c.headChannels;
    op.shift = c.shift;
    op.rows = c.rows;
  }

 private:
  std::span<const float> random(size_t count, float scale) {
    numbers.push_back(test::randomNumbers(count, static_cast<uint32_t>(numbers.size() + 1)));
    for (float& number : numbers.back()) number *= scale;
    return numbers.back();
  }
  // Of which the outputs are about as large as the inputs.
  SwinLayer::Map map(uint32_t outputs, uint32_t inputs) {
    const float scale = inputs == 1 ? 1 : std::sqrt(3.0F / static_cast<float>(inputs));
    return {random(size_t{outputs} * inputs, scale), random(outputs, 0.5F)};
  }
};

DeviceTraits fusedTraits() { return test::traitsOf(KernelFamily::fused); }

class SwinLayerCases : public testing::TestWithParam<Case> {};

TEST_P(SwinLayerCases, MatchesReference) {
  const RandomLayer layer(GetParam());
  if (!fits(layer.op, fusedTraits())) GTEST_SKIP() << "not enough shared memory for a window";
  test::expectMatchesReference(layer.op, fusedTraits(), test::toleranceOf(DataType::f16));
}

INSTANTIATE_TEST_SUITE_P(All, SwinLayerCases, testing::ValuesIn(kCases));

// Equal tokens in equal windows: attention returns the values, whatever the scores, so all outputs of a window are
// equal but for the mask, which changes nothing either.
TEST(SwinLayer, MakesEqualTokensOfEqualTokens) {
  RandomLayer layer({16, 16, 32, 16, 64, 16, 4});
  std::vector<float> token = test::randomNumbers(32, 99), tokens;
  for (uint32_t i = 0; i < 16 * 16; ++i) tokens.insert(tokens.end(), token.begin(), token.end());
  test::expectMatchesReference(layer.op, fusedTraits(), test::toleranceOf(DataType::f16), {{0, tokens}});
}

// Scores of some hundreds, of which one key takes all.
TEST(SwinLayer, KeepsLargeScoresFinite) {
  RandomLayer layer({8, 8, 32, 32, 64, 32, 0});
  std::vector<float> weight(layer.op.qkv.weight.begin(), layer.op.qkv.weight.end());
  for (float& w : weight) w *= 8;
  layer.op.qkv.weight = weight;
  test::expectMatchesReference(layer.op, fusedTraits(), {3e-2, 3e-1});
}

TEST(SwinLayer, FitsHalvesInSixteensOnMatrixUnits) {
  const DeviceTraits gpu{.family = KernelFamily::fused,
                         .matrixUnits = MatrixUnits::nv,
                         .subgroupSize = 32,
                         .maxSharedBytes = 49152,
                         .maxGroupInvocations = 1024};
  const auto fitsWith = [&](auto&& change) {
    RandomLayer layer({8, 8, 192, 32, 384, 64});
    DeviceTraits device = gpu;
    change(layer.op, device);
    return fits(layer.op, device);
  };
  EXPECT_TRUE(fitsWith([](SwinLayer&, DeviceTraits&) {}));
  EXPECT_FALSE(fitsWith([](SwinLayer&, DeviceTraits& device) { device.family = KernelFamily::matrix; }));
  EXPECT_FALSE(fitsWith([](SwinLayer&, DeviceTraits& device) { device.matrixSize.halfSums = false; }));
  EXPECT_FALSE(fitsWith([](SwinLayer&, DeviceTraits& device) { device.maxSharedBytes = 32768; }));
  EXPECT_FALSE(fitsWith([](SwinLayer& op, DeviceTraits&) { op.input.type = DataType::f32; }));
  std::vector<float> table(15 * 15 * 6, 17);
  EXPECT_FALSE(fitsWith([&](SwinLayer& op, DeviceTraits&) { op.biasTable = table; }));
}

TEST(SwinLayer, RefusesWeightsOfOtherSizes) {
  RandomLayer layer({8, 8, 16, 16, 32, 0});
  layer.op.fc2.weight = layer.op.fc2.weight.first(16);
  EXPECT_THROW(outputShape(layer.op), std::logic_error);
}

}  // namespace
}  // namespace xrds::swin_layer_test
