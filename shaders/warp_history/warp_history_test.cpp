#include "shaders/warp_history/warp_history.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::warp_history_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, scale = 1;
  RowRange rows{};
};

constexpr Shape kShapes[] = {{1, 1}, {1, 9, 4}, {9, 1}, {13, 17, 2, {4, 7}}, {13, 17, 1, {5, 13}}, {33, 70, 4}};

WarpHistory warpOf(const Shape& s) {
  return {.positions = view(0, DataType::f32, s.height, s.width, 4),
          .history = view(1, DataType::f32, s.height, s.width, shader::kHistoryFrame),
          .present = view(2, DataType::f32, s.height, s.width, shader::kHistoryFrame),
          .exposure = view(3, DataType::f32, 1, 1, 4),
          .output = view(4, DataType::f32, s.height, s.width, shader::kHistoryWarped),
          .scale = s.scale,
          .rows = s.rows};
}

// Positions inside and outside of the image; radiance and guides of at least 0, some nearnesses 0 in both.
test::Contents contentsOf(const WarpHistory& op) {
  test::Contents contents{{3, {1.5F, 1 / 1.5F, 0, 0}}};
  contents[0] = test::randomNumbers(op.positions.storedElementCount(), 3);
  for (size_t i = 0; i < contents[0].size(); ++i) {
    const auto side = static_cast<float>(op.scale * (i % 4 == 0 ? op.history.width : op.history.height));
    contents[0][i] = i % 4 == 2 ? std::abs(contents[0][i]) : side * (0.5F + 0.7F * contents[0][i]);
  }
  for (const ValueId frame : {1U, 2U}) {
    contents[frame] = test::randomNumbers(op.history.storedElementCount(), frame);
    for (size_t i = 0; i < contents[frame].size(); ++i)
      if (i % 12 < 8) contents[frame][i] = i % 12 == 7 && i % 5 == 0 ? 0 : std::abs(contents[frame][i]);
  }
  return contents;
}

class WarpHistoryShapes : public testing::TestWithParam<Shape> {};

TEST_P(WarpHistoryShapes, MatchesReference) {
  const WarpHistory op = warpOf(GetParam());
  test::expectMatchesReference(op, contentsOf(op));
}

INSTANTIATE_TEST_SUITE_P(All, WarpHistoryShapes, testing::ValuesIn(kShapes));

// A texture under constant light stays constant light, however far between pixels it is read.
TEST(WarpHistory, InterpolatesTheLightAndNotTheTexture) {
  const WarpHistory op = warpOf({4, 4});
  HostMemory memory;
  memory.storage(op.exposure) = {1, 1, 0, 0};
  for (uint32_t y = 0; y < 4; ++y)
    for (uint32_t x = 0; x < 4; ++x) {
      memory.at(op.positions, y, x, 0) = x + 0.3;
      memory.at(op.positions, y, x, 1) = y + 0.6;
      memory.at(op.positions, y, x, 2) = 1;
      for (const TensorView& frame : {op.history, op.present})
        for (uint32_t c = 0; c < 3; ++c) {
          const double albedo = (x + y) % 2 ? 0.9 : 0.1;
          memory.at(frame, y, x, c) = 3 * (albedo + shader::kAlbedoEpsilon);
          memory.at(frame, y, x, 4 + c) = albedo;
        }
      memory.at(op.history, y, x, 3) = 1;
    }
  reference(op, memory);
  for (uint32_t y = 0; y < 4; ++y)
    for (uint32_t x = 0; x < 4; ++x) {
      EXPECT_NEAR(memory.at(op.output, y, x, 0), 3, 1e-6);
      EXPECT_NEAR(memory.at(op.output, y, x, 4), 0, 1e-6);
      EXPECT_EQ(memory.at(op.output, y, x, 3), 1);
    }
}

TEST(WarpHistory, RefusesWhatDoesNotFit) {
  WarpHistory op = warpOf({8, 8});
  op.history = view(1, DataType::f32, 8, 7, shader::kHistoryFrame);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = warpOf({8, 8, 3});
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = warpOf({8, 8});
  op.positions = {};
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

// A thin bar that is read between two pixels of it keeps more contrast than by bilinear interpolation, and nothing is
// brighter or darker than what lies around.
TEST(WarpHistory, KeepsTheEdgesOfGuides) {
  constexpr uint32_t kWidth = 12, kBar = 5;
  const WarpHistory op = warpOf({1, kWidth});
  HostMemory memory;
  memory.storage(op.exposure) = {1, 1, 0, 0};
  const auto albedo = [](uint32_t x) { return x == kBar || x == kBar + 1 ? 0.9 : 0.1; };
  for (uint32_t x = 0; x < kWidth; ++x) {
    memory.at(op.positions, 0, x, 0) = x + 0.25;
    for (uint32_t c = 0; c < 3; ++c) memory.at(op.history, 0, x, 4 + c) = albedo(x);
  }
  reference(op, memory);
  for (uint32_t x = 1; x + 2 < kWidth; ++x) {
    const double found = memory.at(op.output, 0, x, 8), low = std::min(albedo(x), albedo(x + 1));
    EXPECT_GE(found, low - 1e-12) << x;
    EXPECT_LE(found, std::max(albedo(x), albedo(x + 1)) + 1e-12) << x;
  }
  const double bilinear = 0.75 * 0.9 + 0.25 * 0.1;
  EXPECT_NEAR(memory.at(op.output, 0, kBar, 8), 0.9, 1e-12);
  EXPECT_GT(memory.at(op.output, 0, kBar + 1, 8), bilinear + 0.03);
  EXPECT_LT(memory.at(op.output, 0, kBar - 1, 8), 0.75 * 0.1 + 0.25 * 0.9 - 0.03);
}

}  // namespace
}  // namespace xrds::warp_history_test
