#include "shaders/upsample_nearest/upsample_nearest.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::upsample_nearest_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, channels;  // of the input
  RowRange rows{};                   // of the output
};

// One pixel, thin images, rows that begin and end within a pixel of the input.
constexpr Shape kShapes[] = {{1, 1, 4}, {1, 9, 8}, {9, 1, 12}, {5, 7, 20, {3, 8}}, {6, 33, 32, {4, 7}}, {16, 20, 16}};

UpsampleNearest upsampleOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.input = view(0, inputType, s.height, s.width, s.channels, 4, s.channels + 8),
          .output = view(1, outputType, 2 * s.height, 2 * s.width, s.channels, 8, s.channels + 12),
          .rows = s.rows};
}

class UpsampleNearestShapes : public testing::TestWithParam<std::tuple<Shape, KernelFamily, DataType, DataType>> {};

TEST_P(UpsampleNearestShapes, MatchesReference) {
  const auto& [s, family, inputType, outputType] = GetParam();
  test::expectMatchesReference(upsampleOf(s, inputType, outputType), test::traitsOf(family),
                               test::toleranceOf(outputType));
}

INSTANTIATE_TEST_SUITE_P(All, UpsampleNearestShapes,
                         testing::Combine(testing::ValuesIn(kShapes),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane),
                                          testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(UpsampleNearest, RepeatsPixels) {
  const UpsampleNearest op = upsampleOf({2, 2, 4});
  HostMemory memory;
  for (uint32_t i = 0; i < 4; ++i) memory.at(op.input, i / 2, i % 2, 3) = i + 1;
  reference(op, memory);
  for (uint32_t i = 0; i < 16; ++i) EXPECT_EQ(memory.at(op.output, i / 4, i % 4, 3), i / 8 * 2 + i % 4 / 2 + 1) << i;
}

TEST(UpsampleNearest, RefusesOtherSizes) {
  UpsampleNearest op = upsampleOf({4, 4, 8});
  op.output = view(1, DataType::f32, 8, 9, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::upsample_nearest_test
