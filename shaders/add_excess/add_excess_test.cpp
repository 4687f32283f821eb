#include "shaders/add_excess/add_excess.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::add_excess_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width;
  RowRange rows{};
};

constexpr Shape kShapes[] = {{1, 1}, {1, 9}, {9, 1}, {11, 13, {3, 8}}, {16, 20}, {33, 35}};

AddExcess excessOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.input = view(0, inputType, s.height, s.width, 4, 4, 12),
          .image = view(1, inputType, s.height, s.width, 4, 8, 12),
          .output = view(2, outputType, s.height, s.width, 4, 4, 8),
          .rows = s.rows};
}

class AddExcessShapes : public testing::TestWithParam<std::tuple<Shape, KernelFamily, DataType, DataType>> {};

// Images from -2 to 4, so that a third of the numbers is between 0 and 1.
TEST_P(AddExcessShapes, MatchesReference) {
  const auto& [s, family, inputType, outputType] = GetParam();
  auto image = test::randomNumbers(size_t{s.height} * s.width * 12, 3);
  for (float& number : image) number = 1 + 3 * number;
  test::expectMatchesReference(excessOf(s, inputType, outputType), test::traitsOf(family),
                               test::toleranceOf(outputType), {{1, image}});
}

INSTANTIATE_TEST_SUITE_P(All, AddExcessShapes,
                         testing::Combine(testing::ValuesIn(kShapes),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane),
                                          testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(AddExcess, AddsWhatIsAboveOneAndBelowZero) {
  const AddExcess op = excessOf({1, 1});
  HostMemory memory;
  const double images[] = {0.25, 1, 3.5, -0.5};
  for (uint32_t c = 0; c < 4; ++c) {
    memory.at(op.input, 0, 0, c) = 0.5;
    memory.at(op.image, 0, 0, c) = images[c];
  }
  reference(op, memory);
  const double expected[] = {0.5, 0.5, 3, 0};
  for (uint32_t c = 0; c < 4; ++c) EXPECT_EQ(memory.at(op.output, 0, 0, c), expected[c]) << c;
}

TEST(AddExcess, RefusesOtherSizes) {
  AddExcess op = excessOf({4, 4});
  op.image = view(1, DataType::f32, 4, 5, 4);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::add_excess_test
