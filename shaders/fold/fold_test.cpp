#include "shaders/fold/fold.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::fold_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, channels;  // of the input, of the patches
  RowRange rows{};
};

// One patch, of which a middle of 2 x 2 pixels is left, thin images, rows that begin and end inside of patches.
constexpr Shape kShapes[] = {{1, 1, 3}, {1, 9, 1}, {9, 1, 4}, {5, 7, 3, {3, 8}}, {6, 33, 6, {4, 7}}, {32, 40, 3}};

Fold foldOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.input = view(0, inputType, s.height, s.width, 16 * s.channels, 4, 16 * s.channels + 8),
          .output = view(1, outputType, 2 * s.height, 2 * s.width, alignUp(s.channels, 4), 4, 12),
          .rows = s.rows};
}

class FoldShapes : public testing::TestWithParam<std::tuple<Shape, KernelFamily, DataType, DataType>> {};

TEST_P(FoldShapes, MatchesReference) {
  const auto& [s, family, inputType, outputType] = GetParam();
  test::expectMatchesReference(foldOf(s, inputType, outputType), test::traitsOf(family), test::toleranceOf(outputType));
}

INSTANTIATE_TEST_SUITE_P(All, FoldShapes,
                         testing::Combine(testing::ValuesIn(kShapes),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane),
                                          testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

// A patch of its own stands around its pixel; two side by side overlap in two columns.
TEST(Fold, PutsPatchesAroundTheirPixels) {
  const Fold op{.input = view(0, DataType::f32, 3, 4, 16), .output = view(1, DataType::f32, 6, 8, 4)};
  HostMemory memory;
  for (uint32_t i = 0; i < 16; ++i) {
    memory.at(op.input, 1, 1, i) = i + 1;
    memory.at(op.input, 1, 2, i) = 100;
  }
  reference(op, memory);
  for (uint32_t y = 0; y < 6; ++y)
    for (uint32_t x = 0; x < 8; ++x) {
      const bool inRows = y >= 1 && y < 5;
      const double first = inRows && x >= 1 && x < 5 ? 4 * (y - 1) + x - 1 + 1 : 0;
      const double second = inRows && x >= 3 && x < 7 ? 100 : 0;
      EXPECT_EQ(memory.at(op.output, y, x, 0), first + second) << y << " " << x;
      EXPECT_EQ(memory.at(op.output, y, x, 1), 0);
    }
}

TEST(Fold, RefusesWhatIsNoPatch) {
  Fold op = foldOf({2, 2, 3});
  op.input = view(0, DataType::f32, 2, 2, 40);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = foldOf({2, 2, 3});
  op.output = view(1, DataType::f32, 4, 4, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::fold_test
