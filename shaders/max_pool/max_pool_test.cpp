#include "shaders/max_pool/max_pool.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::max_pool_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, channels;  // of the output
  RowRange rows{};
};

// One pixel, thin images, rows of a band.
constexpr Shape kShapes[] = {{1, 1, 4}, {1, 9, 8}, {9, 1, 12}, {5, 7, 20, {2, 4}}, {6, 33, 32, {0, 5}}, {32, 40, 16}};

MaxPool poolOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.input = view(0, inputType, 2 * s.height, 2 * s.width, s.channels, 4, s.channels + 8),
          .output = view(1, outputType, s.height, s.width, s.channels, 4, s.channels + 4),
          .rows = s.rows};
}

class MaxPoolShapes : public testing::TestWithParam<std::tuple<Shape, KernelFamily, DataType, DataType>> {};

TEST_P(MaxPoolShapes, MatchesReference) {
  const auto& [s, family, inputType, outputType] = GetParam();
  test::expectMatchesReference(poolOf(s, inputType, outputType), test::traitsOf(family), test::toleranceOf(outputType));
}

INSTANTIATE_TEST_SUITE_P(All, MaxPoolShapes,
                         testing::Combine(testing::ValuesIn(kShapes),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane),
                                          testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(MaxPool, TakesTheLargestOfEachChannel) {
  const MaxPool op = poolOf({1, 2, 4});
  HostMemory memory;
  for (uint32_t i = 0; i < 4; ++i) memory.at(op.input, i / 2, 2 + i % 2, i) = -1 - static_cast<double>(i);
  for (uint32_t i = 0; i < 4; ++i) memory.at(op.input, i / 2, i % 2, 1) = i == 2 ? 7 : -9;
  reference(op, memory);
  EXPECT_EQ(memory.at(op.output, 0, 0, 1), 7);
  EXPECT_EQ(memory.at(op.output, 0, 1, 2), 0);  // of -3 and three zeros
}

TEST(MaxPool, RefusesOddSides) {
  MaxPool op = poolOf({4, 4, 8});
  op.input = view(0, DataType::f32, 8, 7, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = poolOf({4, 4, 8});
  op.output = view(1, DataType::f32, 4, 5, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::max_pool_test
