#include "shaders/follow_motion/follow_motion.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::follow_motion_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width;
  bool first = false;
  RowRange rows{};
};

constexpr Shape kShapes[] = {{1, 1}, {1, 9, true}, {9, 1}, {13, 17, false, {4, 7}}, {13, 17, true, {5, 13}}, {33, 70}};

FollowMotion followOf(const Shape& s) {
  FollowMotion op{.motion = view(1, DataType::f32, s.height, s.width, 4),
                  .output = view(2, DataType::f32, s.height, s.width, 4),
                  .rows = s.rows};
  if (!s.first) op.positions = view(0, DataType::f32, s.height, s.width, 4);
  return op;
}

// Positions inside and outside of the image, steps of up to eight pixels.
test::Contents contentsOf(const FollowMotion& op) {
  test::Contents contents;
  contents[0] = test::randomNumbers(op.motion.storedElementCount(), 3);
  contents[1] = test::randomNumbers(op.motion.storedElementCount(), 4);
  for (size_t i = 0; i < contents[0].size(); ++i) {
    const auto side = static_cast<float>(i % 4 == 0 ? op.motion.width : op.motion.height);
    contents[0][i] = i % 4 == 2 ? float(i % 3 != 0) : side * (0.5F + 0.7F * contents[0][i]);
    contents[1][i] *= 8;
  }
  return contents;
}

class FollowMotionShapes : public testing::TestWithParam<Shape> {};

TEST_P(FollowMotionShapes, MatchesReference) {
  const FollowMotion op = followOf(GetParam());
  test::expectMatchesReference(op, contentsOf(op));
}

INSTANTIATE_TEST_SUITE_P(All, FollowMotionShapes, testing::ValuesIn(kShapes));

// Two steps of a picture that moves by (2, -1): the second starts where the first has led.
TEST(FollowMotion, FollowsAChainOfFramesUntilItLeavesTheImage) {
  FollowMotion op = followOf({6, 8, true});
  HostMemory memory;
  for (uint32_t y = 0; y < 6; ++y)
    for (uint32_t x = 0; x < 8; ++x) {
      memory.at(op.motion, y, x, 0) = x == 4 && y == 2 ? 2 : 0.25;
      memory.at(op.motion, y, x, 1) = x == 4 && y == 2 ? -1 : 0;
    }
  reference(op, memory);
  EXPECT_EQ(memory.at(op.output, 2, 4, 0), 6);
  EXPECT_EQ(memory.at(op.output, 2, 4, 1), 1);
  EXPECT_EQ(memory.at(op.output, 2, 4, 2), 1);
  FollowMotion second = followOf({6, 8});
  memory.storage(second.positions) = memory.storage(op.output);
  reference(second, memory);
  EXPECT_EQ(memory.at(second.output, 2, 4, 0), 6.25);
  EXPECT_EQ(memory.at(second.output, 2, 4, 2), 1);
  memory.at(op.motion, 1, 6, 0) = 1.5;  // to the edge of the last pixel
  reference(second, memory);
  EXPECT_EQ(memory.at(second.output, 2, 4, 0), 7.5);
  EXPECT_EQ(memory.at(second.output, 2, 4, 2), 0);
}

TEST(FollowMotion, RefusesWhatDoesNotFit) {
  FollowMotion op = followOf({8, 8});
  op.positions = view(0, DataType::f32, 8, 7, 4);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = followOf({8, 8});
  op.motion = view(1, DataType::f32, 8, 8, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::follow_motion_test
