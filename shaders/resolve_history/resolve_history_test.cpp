#include "shaders/resolve_history/resolve_history.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::resolve_history_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, guideChannels = 0;
  RowRange rows{};
};

constexpr Shape kShapes[] = {{1, 1}, {1, 9, 4}, {9, 1, 12}, {13, 17, 0, {4, 7}}, {13, 17, 4, {5, 13}}, {33, 70}};

ResolveHistory resolveOf(const Shape& s) {
  ResolveHistory op{.sums = view(0, DataType::f32, s.height, s.width, shader::kHistoryFrame),
                    .output = view(2, DataType::f32, s.height, s.width, s.guideChannels ? 4 : 12),
                    .rows = s.rows};
  if (s.guideChannels) op.guides = view(1, DataType::f32, s.height, s.width, s.guideChannels);
  return op;
}

class ResolveHistoryShapes : public testing::TestWithParam<Shape> {};

TEST_P(ResolveHistoryShapes, MatchesReference) {
  const ResolveHistory op = resolveOf(GetParam());
  test::Contents contents;
  contents[0] = test::randomNumbers(op.sums.storedElementCount(), 5);
  for (size_t i = 3; i < contents[0].size(); i += 4) contents[0][i] = 0.5F + std::abs(contents[0][i]);
  test::expectMatchesReference(op, contents);
}

INSTANTIATE_TEST_SUITE_P(All, ResolveHistoryShapes, testing::ValuesIn(kShapes));

TEST(ResolveHistory, DividesBySumsOfWeightsAndMultipliesByTheAlbedo) {
  const ResolveHistory op = resolveOf({1, 1}), guided = resolveOf({1, 1, 4});
  HostMemory memory;
  memory.storage(op.sums) = {8, 8, 8, 4, 3, 3, 3, 1.5, 0, 0, 3, 3};
  reference(op, memory);
  EXPECT_NEAR(memory.at(op.output, 0, 0, 0), 2 * 1.02, 1e-6);
  EXPECT_EQ(memory.at(op.output, 0, 0, 3), 4);
  EXPECT_EQ(memory.at(op.output, 0, 0, 7), 0.5);
  EXPECT_EQ(memory.at(op.output, 0, 0, 10), 1);
  HostMemory other;
  other.storage(guided.sums) = memory.storage(op.sums);
  other.storage(guided.guides) = {0.5, 0.5, 0.5, 0};
  reference(guided, other);
  EXPECT_NEAR(other.at(guided.output, 0, 0, 0), 2 * 0.52, 1e-6);
}

TEST(ResolveHistory, RefusesWhatDoesNotFit) {
  ResolveHistory op = resolveOf({8, 8, 4});
  op.output = view(2, DataType::f32, 8, 8, 12);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = resolveOf({8, 8, 4});
  op.guides = view(1, DataType::f32, 8, 7, 4);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::resolve_history_test
