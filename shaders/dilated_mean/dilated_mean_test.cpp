#include "shaders/dilated_mean/dilated_mean.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::dilated_mean_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth, channels, step;
  RowRange rows{};
};

// Odd ones first: one pixel, thin images, steps beyond the image, padding that must not be read.
constexpr Shape kShapes[] = {{1, 1, 8, 8, 4, 1},
                             {1, 9, 1, 9, 8, 3},
                             {9, 1, 16, 8, 4, 9},
                             {5, 7, 8, 8, 12, 27},
                             {9, 13, 16, 16, 8, 3, {4, 7}},
                             {11, 13, 11, 13, 16, 1, {0, 5}},
                             {33, 37, 40, 40, 8, 3}};

DilatedMean meanOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.input = view(0, inputType, s.paddedHeight, s.paddedWidth, s.channels),
          .output = view(1, outputType, s.height, s.width, s.channels),
          .step = s.step,
          .rows = s.rows};
}

class DilatedMeanShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType>> {};

TEST_P(DilatedMeanShapes, MatchesReference) {
  const auto& [s, inputType, outputType] = GetParam();
  test::expectMatchesReference(meanOf(s, inputType, outputType));
}

INSTANTIATE_TEST_SUITE_P(All, DilatedMeanShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(DilatedMean, WritesASliceOfWhatItReadsAnotherOf) {
  DilatedMean op = meanOf({7, 5, 7, 5, 8, 3});
  op.input = view(0, DataType::f32, 7, 5, 8, 4, 16);
  op.output = view(1, DataType::f32, 7, 5, 8, 8, 20);
  test::expectMatchesReference(op);
}

// Of such means the mean of 9 x 9 pixels.
TEST(DilatedMean, OfMeansIsTheMeanOfMore) {
  const DilatedMean first = meanOf({21, 21, 21, 21, 4, 1});
  DilatedMean second = meanOf({21, 21, 21, 21, 4, 3});
  second.input.value = 1;
  second.output.value = 2;
  HostMemory memory;
  double sum = 0;
  for (uint32_t y = 0; y < 21; ++y)
    for (uint32_t x = 0; x < 21; ++x) {
      const double value = memory.at(first.input, y, x, 2) = (7 * y + 3 * x * x) % 11;
      if (y >= 6 && y < 15 && x >= 6 && x < 15) sum += value;
    }
  reference(first, memory);
  reference(second, memory);
  EXPECT_NEAR(memory.at(second.output, 10, 10, 2), sum / 81, 1e-5);
}

TEST(DilatedMean, RefusesWhatDoesNotFit) {
  EXPECT_THROW(dispatch(meanOf({8, 8, 8, 7, 8, 1}), {}), std::logic_error);
  EXPECT_THROW(dispatch(meanOf({8, 8, 8, 8, 6, 1}), {}), std::logic_error);
  EXPECT_THROW(dispatch(meanOf({8, 8, 8, 8, 8, 0}), {}), std::logic_error);
  DilatedMean op = meanOf({8, 8, 8, 8, 8, 1});
  op.output.channels = op.output.channelStride = 4;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::dilated_mean_test
