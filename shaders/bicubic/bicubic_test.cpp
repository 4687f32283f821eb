#include "shaders/bicubic/bicubic.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::bicubic_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth, scale;  // of the input
  RowRange rows{};
};

// Odd ones first: one pixel, one row, one column, rows inside a run and across runs, the last row; then every scale.
constexpr Shape kShapes[] = {{1, 1, 1, 1, 16},         {1, 1, 8, 8, 4},          {1, 9, 8, 16, 2},
                             {9, 1, 16, 8, 8},         {5, 7, 8, 8, 4, {3, 10}}, {5, 7, 8, 8, 4, {2, 3}},
                             {5, 7, 8, 8, 2, {9, 10}}, {5, 7, 8, 8, 8, {1, 39}}, {13, 9, 16, 16, 1},
                             {13, 9, 16, 16, 2},       {13, 9, 16, 16, 4},       {6, 5, 8, 8, 8},
                             {3, 4, 4, 4, 16},         {16, 16, 16, 16, 4}};

Bicubic bicubicOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.input = view(0, inputType, s.paddedHeight, s.paddedWidth, 4),
          .output = view(1, outputType, s.height * s.scale, s.width * s.scale, 4),
          .scale = s.scale,
          .rows = s.rows};
}

class BicubicShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType>> {};

TEST_P(BicubicShapes, MatchesReference) {
  const auto& [s, inputType, outputType] = GetParam();
  test::expectMatchesReference(bicubicOf(s, inputType, outputType));
}

INSTANTIATE_TEST_SUITE_P(All, BicubicShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(Bicubic, ReadsAndWritesSlices) {
  test::expectMatchesReference(Bicubic{
      .input = view(0, DataType::f32, 5, 8, 4, 4, 8), .output = view(1, DataType::f32, 16, 28, 4, 4, 12), .scale = 4});
}

// As PyTorch's interpolate(mode="bicubic", align_corners=False): at a scale of 4 the distances are odd eighths.
TEST(Bicubic, OfAnImpulseIsTheKernel) {
  const Bicubic op = bicubicOf({1, 8, 1, 8, 4});
  HostMemory memory;
  memory.at(op.input, 0, 3, 0) = 1;
  reference(op, memory);
  const double kernel[] = {0.96728515625,  0.74951171875,  0.42626953125,  0.11474609375,
                           -0.07177734375, -0.10986328125, -0.06591796875, -0.01025390625};
  for (uint32_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(memory.at(op.output, 0, 14 + i, 0), kernel[i], 1e-12);
    EXPECT_NEAR(memory.at(op.output, 0, 13 - i, 0), kernel[i], 1e-12);
  }
}

TEST(Bicubic, KeepsAConstantImage) {
  const Bicubic op = bicubicOf({3, 4, 3, 4, 4});
  HostMemory memory;
  for (double& value : memory.storage(op.input)) value = 0.75;
  reference(op, memory);
  for (const double value : memory.storage(op.output)) EXPECT_NEAR(value, 0.75, 1e-12);
}

TEST(Bicubic, RefusesWhatDoesNotFit) {
  Bicubic op = bicubicOf({4, 4, 4, 4, 4});
  op.output.width = 18;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  EXPECT_THROW(dispatch(bicubicOf({4, 4, 4, 3, 4}), {}), std::logic_error);
  EXPECT_THROW(dispatch(bicubicOf({4, 4, 4, 4, 6}), {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::bicubic_test
