#include "shaders/winograd_output/winograd_output.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::winograd_output_test {
namespace {

using test::PrintTo;
using test::view;

struct Case {
  uint32_t height, width, channels;  // of the convolution
  Activation activation = Activation::none;
  bool residual = false, inPlace = false;
  RowRange rows{};
};

// Less than a square, rows that end inside of one, more squares than lanes, rows of a band, the activations.
constexpr Case kCases[] = {{1, 4, 4},
                           {4, 4, 8, Activation::relu},
                           {6, 8, 12, Activation::leakyRelu, true},
                           {13, 20, 20, Activation::gelu, true, true},
                           {18, 76, 32, Activation::none, true, true},
                           {23, 36, 16, Activation::relu, true, false, {8, 20}},
                           {11, 132, 4, Activation::none, true, true, {8, 11}},
                           {12, 36, 36}};

WinogradOutput outputOf(const Case& c, DataType stored, std::span<const float> bias) {
  WinogradOutput op{
      .input = view(0, DataType::f32, ceilDivide(c.height, 4), c.width / 4, 36 * c.channels, 8, 36 * c.channels + 16),
      .output = view(1, stored, c.height, c.width, c.channels, 4, c.channels + 8),
      .bias = bias,
      .activation = c.activation,
      .rows = c.rows};
  if (c.residual) op.residual = c.inPlace ? op.output : view(2, stored, c.height, c.width, c.channels);
  return op;
}

class WinogradOutputCases : public testing::TestWithParam<std::tuple<Case, KernelFamily, DataType>> {};

TEST_P(WinogradOutputCases, MatchesReference) {
  const auto& [c, family, stored] = GetParam();
  const auto bias = test::randomNumbers(c.channels, 2);
  test::expectMatchesReference(outputOf(c, stored, bias), test::traitsOf(family), toleranceOf(stored));
}

INSTANTIATE_TEST_SUITE_P(All, WinogradOutputCases,
                         testing::Combine(testing::ValuesIn(kCases),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(WinogradOutput, ShufflesItsOutput) {
  const auto bias = test::randomNumbers(32, 2);
  for (const KernelFamily family : {KernelFamily::plain, KernelFamily::lane})
    for (const bool inPlace : {false, true}) {
      WinogradOutput op = outputOf({7, 12, 32, Activation::relu, false, false, {4, 7}}, DataType::f32, bias);
      op.output = view(1, DataType::f32, 14, 24, 8);
      op.residual = inPlace ? op.output : view(2, DataType::f32, 14, 24, 8);
      op.shuffleOutput = true;
      op.firstOutput = inPlace ? 0 : 2;  // the last of which have no bias
      test::expectMatchesReference(op, test::traitsOf(family), toleranceOf(DataType::f32));
    }
}

TEST(WinogradOutput, PoolsItsOutput) {
  const auto bias = test::randomNumbers(12, 2);
  for (const auto& [shape, rows] : {std::pair{Case{2, 4, 4}, RowRange{}},
                                    {Case{14, 76, 12, Activation::relu}, RowRange{}},
                                    {Case{22, 20, 8, Activation::relu}, RowRange{2, 8}}})
    for (const KernelFamily family : {KernelFamily::plain, KernelFamily::lane})
      for (const DataType stored : {DataType::f32, DataType::f16}) {
        WinogradOutput op = outputOf(shape, stored, bias);
        op.output = view(1, stored, shape.height / 2, shape.width / 2, shape.channels, 4, shape.channels + 8);
        op.pooled = true;
        op.rows = rows;
        test::expectMatchesReference(op, test::traitsOf(family), toleranceOf(stored));
      }
}

// A product of plane (0, 0) alone is in the first pixel of the square, beside the bias.
TEST(WinogradOutput, PutsTheCornerInTheCorner) {
  const std::vector<float> bias{1, 2, 3, 4};
  const WinogradOutput op{
      .input = view(0, DataType::f32, 1, 1, 144), .output = view(1, DataType::f32, 4, 4, 4), .bias = bias};
  HostMemory memory;
  memory.at(op.input, 0, 0, 1) = 5;
  reference(op, memory);
  for (uint32_t i = 0; i < 16; ++i) EXPECT_EQ(memory.at(op.output, i / 4, i % 4, 1), i == 0 ? 7 : 2) << i;
}

TEST(WinogradOutput, RefusesWhatDoesNotFit) {
  const std::vector<float> bias(8);
  const WinogradOutput op = outputOf({9, 8, 8}, DataType::f32, bias);
  EXPECT_NO_THROW(dispatch(op, {}));
  WinogradOutput wrong = op;
  wrong.rows = {2, 8};
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong.rows = {0, 6};
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong = op;
  wrong.output.height = 13;
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong = outputOf({8, 8, 8, Activation::none, true}, DataType::f32, bias);
  wrong.output = view(1, DataType::f32, 4, 4, 8);
  wrong.pooled = true;
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong.residual = {};
  EXPECT_NO_THROW(dispatch(wrong, {}));
  wrong.rows = {1, 4};
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
}

// More than a row of workgroups makes.
TEST(WinogradOutput, LeavesTheWidestRowsToThePlainKernel) {
  const auto programOf = [](uint32_t width) {
    return dispatch(outputOf({4, width, 256}, DataType::f32, {}), test::traitsOf(KernelFamily::lane)).program;
  };
  EXPECT_EQ(programOf(8192), "winograd_output_lane_f32");
  EXPECT_EQ(programOf(8196), "winograd_output_plain_f32");
}

}  // namespace
}  // namespace xrds::winograd_output_test
