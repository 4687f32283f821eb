#include "shaders/channel_gate/channel_gate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::channel_gate_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, channels, squeezed;
};

constexpr Shape kShapes[] = {{1, 4, 1}, {7, 12, 3}, {300, 64, 4}, {5, 180, 6}, {33, 512, 70}};

struct Weights {
  explicit Weights(const Shape& s)
      : down(test::randomNumbers(size_t{s.squeezed} * s.channels, 1)),
        bias(test::randomNumbers(s.squeezed, 2)),
        up(test::randomNumbers(size_t{s.squeezed} * s.channels, 3)),
        upBias(test::randomNumbers(s.channels, 4)) {}
  std::vector<float> down, bias, up, upBias;
};

ChannelGate gateOf(const Shape& s, const Weights& weights) {
  return {.input = view(0, DataType::f32, s.height, 1, s.channels, 4, s.channels + 8),
          .output = view(1, DataType::f32, 1, 1, s.channels),
          .weight = weights.down,
          .bias = weights.bias,
          .upWeight = weights.up,
          .upBias = weights.upBias};
}

class ChannelGateShapes : public testing::TestWithParam<Shape> {};

TEST_P(ChannelGateShapes, MatchesReference) {
  const Weights weights(GetParam());
  test::expectMatchesReference(gateOf(GetParam(), weights), test::traitsOf(KernelFamily::plain),
                               toleranceOf(DataType::f32));
}

INSTANTIATE_TEST_SUITE_P(All, ChannelGateShapes, testing::ValuesIn(kShapes));

// A negative squeezed channel leaves the bias alone; a positive one adds its weight.
TEST(ChannelGate, SqueezesRectifiesAndGates) {
  const std::vector<float> down{1, 0, 0, 0}, bias{-2}, up{1, 2, 0, 0}, upBias{0, 0, 1, 0};
  ChannelGate op{.input = view(0, DataType::f32, 2, 1, 4), .output = view(1, DataType::f32, 1, 1, 4)};
  op.weight = down, op.bias = bias, op.upWeight = up, op.upBias = upBias;
  HostMemory memory;
  memory.at(op.input, 0, 0, 0) = 1;
  reference(op, memory);
  EXPECT_EQ(memory.at(op.output, 0, 0, 1), 0.5);
  memory.at(op.input, 1, 0, 0) = 6;  // mean 3.5, squeezed 1.5
  reference(op, memory);
  EXPECT_DOUBLE_EQ(memory.at(op.output, 0, 0, 1), 1 / (1 + std::exp(-3.0)));
  EXPECT_DOUBLE_EQ(memory.at(op.output, 0, 0, 2), 1 / (1 + std::exp(-1.0)));
}

TEST(ChannelGate, RefusesWeightsOfOtherShapes) {
  const Shape shape{3, 8, 2};
  const Weights weights(shape);
  ChannelGate op = gateOf(shape, weights);
  op.upBias = op.upBias.first(4);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = gateOf(shape, weights);
  op.input = view(0, DataType::f16, 3, 1, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::channel_gate_test
