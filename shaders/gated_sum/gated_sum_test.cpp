#include "shaders/gated_sum/gated_sum.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::gated_sum_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, channels;
  RowRange rows{};
  bool hasGate = true;
};

constexpr Shape kShapes[] = {{1, 1, 4},
                             {3, 9, 12},
                             {9, 1, 60},
                             {5, 33, 64, {1, 4}},
                             {16, 40, 256},
                             {3, 9, 12, {}, false},
                             {5, 33, 64, {1, 4}, false}};

GatedSum sumOf(const Shape& s, DataType stored = DataType::f32) {
  return {.input = view(0, stored, s.height, s.width, s.channels, 4, s.channels + 8),
          .output = view(1, stored, s.height, s.width, s.channels, 8, s.channels + 12),
          .gate = s.hasGate ? view(2, DataType::f32, 1, 1, s.channels) : TensorView{},
          .addend = view(3, stored, s.height, s.width, s.channels),
          .rows = s.rows};
}

class GatedSumShapes : public testing::TestWithParam<std::tuple<Shape, KernelFamily, DataType>> {};

TEST_P(GatedSumShapes, MatchesReference) {
  const auto& [s, family, stored] = GetParam();
  test::expectMatchesReference(sumOf(s, stored), test::traitsOf(family), toleranceOf(stored));
}

INSTANTIATE_TEST_SUITE_P(All, GatedSumShapes,
                         testing::Combine(testing::ValuesIn(kShapes),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(GatedSum, ScalesChannelsAndAdds) {
  const GatedSum op = sumOf({2, 2, 4});
  HostMemory memory;
  memory.at(op.input, 1, 0, 2) = 3;
  memory.at(op.gate, 0, 0, 2) = 0.5;
  memory.at(op.addend, 1, 0, 2) = 10;
  reference(op, memory);
  EXPECT_EQ(memory.at(op.output, 1, 0, 2), 11.5);
}

TEST(GatedSum, AddsWithoutGate) {
  const GatedSum op = sumOf({2, 2, 4, {}, false});
  HostMemory memory;
  memory.at(op.input, 1, 0, 2) = 3;
  memory.at(op.addend, 1, 0, 2) = 10;
  reference(op, memory);
  EXPECT_EQ(memory.at(op.output, 1, 0, 2), 13);
}

TEST(GatedSum, RefusesGatesOfOtherShapes) {
  GatedSum op = sumOf({2, 2, 8});
  op.gate = view(2, DataType::f32, 1, 1, 4);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::gated_sum_test
