#include "shaders/box_mean/box_mean.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::box_mean_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, channels, scale;  // of the output
  RowRange rows{};
  uint32_t inputOffset = 0, inputStride = 0, outputOffset = 0, outputStride = 0;
};

// Odd ones first: one pixel, one row, slices, some rows; then every scale.
constexpr Shape kShapes[] = {{1, 1, 4, 16},  {1, 37, 8, 2},  {9, 5, 12, 4, {2, 7}}, {5, 7, 4, 2, {4, 5}, 4, 12, 8, 16},
                             {33, 35, 8, 1}, {17, 33, 8, 4}, {5, 3, 12, 8},         {4, 6, 8, 16}};

BoxMean meanOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.input = view(0, inputType, s.height * s.scale, s.width * s.scale, s.channels, s.inputOffset, s.inputStride),
          .output = view(1, outputType, s.height, s.width, s.channels, s.outputOffset, s.outputStride),
          .scale = s.scale,
          .rows = s.rows};
}

class BoxMeanShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType>> {};

TEST_P(BoxMeanShapes, MatchesReference) {
  const auto& [s, inputType, outputType] = GetParam();
  test::expectMatchesReference(meanOf(s, inputType, outputType));
}

INSTANTIATE_TEST_SUITE_P(All, BoxMeanShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

// Bands: rows of a stored part of an image; one pixel of three vec4 a row, so that no offset is aligned.
TEST(BoxMean, OfOnePixelCopiesRows) {
  for (const DataType type : {DataType::f32, DataType::f16}) {
    BoxMean op = meanOf({9, 5, 12, 1, {4, 7}}, type, type);
    op.input = asRowsOf(view(0, type, 5, 5, 12), 9, 3);
    op.output = asRowsOf(view(1, type, 4, 5, 12), 9, 4);
    EXPECT_TRUE(dispatch(op, {}).isCopy());
    test::expectMatchesReference(op);
  }
}

TEST(BoxMean, OfOnePixelIsNoCopyBetweenSlicesOrTypes) {
  EXPECT_FALSE(dispatch(meanOf({4, 4, 8, 1, {}, 4, 16}), {}).isCopy());
  EXPECT_FALSE(dispatch(meanOf({4, 4, 8, 1, {}, 0, 0, 0, 12}), {}).isCopy());
  EXPECT_FALSE(dispatch(meanOf({4, 4, 8, 1}, DataType::f16, DataType::f32), {}).isCopy());
}

TEST(BoxMean, OfAConstantImageIsTheConstant) {
  const BoxMean op = meanOf({2, 3, 4, 4});
  HostMemory memory;
  for (double& value : memory.storage(op.input)) value = 0.75;
  reference(op, memory);
  for (const double value : memory.storage(op.output)) EXPECT_EQ(value, 0.75);
}

TEST(BoxMean, RefusesWhatDoesNotFit) {
  BoxMean op = meanOf({2, 3, 4, 4});
  op.input.width = 13;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  EXPECT_THROW(dispatch(meanOf({2, 2, 4, 3}), {}), std::logic_error);
  EXPECT_THROW(dispatch(meanOf({2, 2, 4, 32}), {}), std::logic_error);
  EXPECT_THROW(dispatch(meanOf({2, 2, 6, 2}), {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::box_mean_test
