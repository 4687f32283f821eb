#include "shaders/row_mean/row_mean.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::row_mean_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, channels;
  RowRange rows{};
};

constexpr Shape kShapes[] = {{1, 1, 4}, {3, 130, 12}, {9, 1, 60}, {7, 65, 64, {2, 5}}, {32, 40, 180}};

RowMean meanOf(const Shape& s, DataType inputType = DataType::f32) {
  return {.input = view(0, inputType, s.height, s.width, s.channels, 4, s.channels + 8),
          .output = view(1, DataType::f32, s.height, 1, s.channels),
          .rows = s.rows};
}

class RowMeanShapes : public testing::TestWithParam<std::tuple<Shape, DataType>> {};

TEST_P(RowMeanShapes, MatchesReference) {
  const auto& [s, inputType] = GetParam();
  test::expectMatchesReference(meanOf(s, inputType), test::traitsOf(KernelFamily::plain), toleranceOf(DataType::f32));
}

INSTANTIATE_TEST_SUITE_P(All, RowMeanShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16)));

TEST(RowMean, OfARampIsItsMiddle) {
  const RowMean op{.input = view(0, DataType::f32, 2, 5, 4), .output = view(1, DataType::f32, 2, 1, 4)};
  HostMemory memory;
  for (uint32_t y = 0; y < 2; ++y)
    for (uint32_t x = 0; x < 5; ++x) memory.at(op.input, y, x, 1) = 10 * y + x;
  reference(op, memory);
  EXPECT_EQ(memory.at(op.output, 0, 0, 1), 2);
  EXPECT_EQ(memory.at(op.output, 1, 0, 1), 12);
  EXPECT_EQ(memory.at(op.output, 1, 0, 0), 0);
}

TEST(RowMean, RefusesResultsOfOtherShapesAndTypes) {
  RowMean op = meanOf({4, 4, 8});
  op.output = view(1, DataType::f32, 4, 4, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op.output = view(1, DataType::f16, 4, 1, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::row_mean_test
