#include "shaders/merge_history/merge_history.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::merge_history_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, radius = 2;
  bool first = false;
  RowRange rows{};
};

constexpr Shape kShapes[] = {
    {1, 1}, {1, 9, 1, true}, {9, 1, 3}, {13, 17, 2, false, {4, 7}}, {13, 17, 3, true, {5, 13}}, {33, 70, 2}};

MergeHistory mergeOf(const Shape& s) {
  MergeHistory op{.warped = view(0, DataType::f32, s.height, s.width, shader::kHistoryWarped),
                  .present = view(1, DataType::f32, s.height, s.width, shader::kHistoryFrame),
                  .output = view(3, DataType::f32, s.height, s.width, shader::kHistoryFrame),
                  .radius = s.radius,
                  .rows = s.rows};
  if (!s.first) op.sums = view(2, DataType::f32, s.height, s.width, shader::kHistoryFrame);
  return op;
}

// Small differences, so that no weight vanishes everywhere; counts from 0 to 1.
test::Contents contentsOf(const MergeHistory& op) {
  test::Contents contents;
  contents[0] = test::randomNumbers(op.warped.storedElementCount(), 5);
  for (size_t i = 0; i < contents[0].size(); ++i)
    contents[0][i] = i % 16 < 4 ? std::abs(contents[0][i]) : 0.3F * contents[0][i];
  contents[1] = test::randomNumbers(op.present.storedElementCount(), 6);
  for (size_t i = 0; i < contents[1].size(); ++i)
    if (i % 12 < 8) contents[1][i] = std::abs(contents[1][i]);
  return contents;
}

class MergeHistoryShapes : public testing::TestWithParam<Shape> {};

TEST_P(MergeHistoryShapes, MatchesReference) {
  const MergeHistory op = mergeOf(GetParam());
  test::expectMatchesReference(op, contentsOf(op));
}

INSTANTIATE_TEST_SUITE_P(All, MergeHistoryShapes, testing::ValuesIn(kShapes));

/// A frame of grey light 1 before one that differs from it by `change`, seen in the middle.
struct Middle {
  double light = 0, weight = 0, guideWeight = 0;
};
Middle mergedWith(const std::function<void(HostMemory&, const MergeHistory&)>& change) {
  const MergeHistory op = mergeOf({9, 9, 2, true});
  HostMemory memory;
  for (uint32_t y = 0; y < 9; ++y)
    for (uint32_t x = 0; x < 9; ++x)
      for (uint32_t c = 0; c < 4; ++c) {
        memory.at(op.warped, y, x, c) = 1;
        memory.at(op.present, y, x, c) = c < 3 ? shader::kAlbedoEpsilon : 1;
      }
  change(memory, op);
  reference(op, memory);
  return {memory.at(op.output, 4, 4, 0), memory.at(op.output, 4, 4, 3), memory.at(op.output, 4, 4, 11)};
}

TEST(MergeHistory, TakesAFrameThatIsTheSameInFull) {
  const Middle merged = mergedWith([](HostMemory&, const MergeHistory&) {});
  EXPECT_NEAR(merged.light, 2, 1e-6);
  EXPECT_EQ(merged.weight, 2);
  EXPECT_EQ(merged.guideWeight, 2);
}

TEST(MergeHistory, RefusesOtherGuidesAndOtherLight) {
  const auto differing = [](uint32_t channel, double by) {
    return mergedWith([=](HostMemory& memory, const MergeHistory& op) {
      for (uint32_t y = 0; y < 9; ++y)
        for (uint32_t x = 0; x < 9; ++x) memory.at(op.warped, y, x, channel) = by;
    });
  };
  for (const uint32_t guide : {7U, 8U, 9U, 10U, 12U, 13U, 14U}) {
    EXPECT_LT(differing(guide, 1).weight, 1.001) << guide;
    EXPECT_LT(differing(guide, 1).guideWeight, 1.001) << guide;
  }
  EXPECT_NEAR(differing(8, 0.2).weight, 1 + std::exp(-1), 1e-6);  // the albedo that makes it 1 / e
  for (const uint32_t light : {4U, 5U, 6U}) {
    EXPECT_LT(differing(light, 0.1).weight, 1.001) << light;
    EXPECT_EQ(differing(light, 0.1).guideWeight, 2) << light;
  }
}

// A chequerboard of differences is noise as long as its mean is not further from 0 than such noise is.
TEST(MergeHistory, TellsNoiseFromOtherLight) {
  const auto noisy = [](double mean) {
    return mergedWith([=](HostMemory& memory, const MergeHistory& op) {
      for (uint32_t y = 0; y < 9; ++y)
        for (uint32_t x = 0; x < 9; ++x)
          for (uint32_t c = 4; c < 7; ++c) memory.at(op.warped, y, x, c) = ((x + y) % 2 ? 0.2 : -0.2) + mean;
    });
  };
  EXPECT_NEAR(noisy(0).weight, 2, 1e-3);
  // Bias 3 (0.2^2 - 0.2^2 / 25), variance of one frame 3 0.2^2 / 2: the mean of 25 moves the numbers by a hundredth.
  const double ratio = shader::kHistoryBias * 2.0 * 24 / 25;
  EXPECT_NEAR(noisy(0.2).weight, 1 + 1 / (1 + ratio + ratio * ratio), 0.006);
}

// Means of k and n samples differ by the noise of one over k and over n.
TEST(MergeHistory, KnowsOfHowManySamplesAPixelIs) {
  const auto noisy = [](double own, double other) {
    return mergedWith([=](HostMemory& memory, const MergeHistory& op) {
      for (uint32_t y = 0; y < 9; ++y)
        for (uint32_t x = 0; x < 9; ++x) {
          for (uint32_t c = 4; c < 7; ++c) memory.at(op.warped, y, x, c) = ((x + y) % 2 ? 0.2 : -0.2) + 0.2;
          memory.at(op.warped, y, x, 3) = other;
          memory.at(op.present, y, x, 3) = own;
        }
    });
  };
  // 12 of 25 differences are 0.4, 13 are 0: their variance, and the squared bias of their mean.
  const double variance = 0.16 * 12 * 13 / 625;
  const auto expected = [&](double own, double other) {
    const double luck = std::clamp(other / own, 1.0, 4.0), bias = 0.16 * 12 * 12 / 625 - luck * variance / 25;
    const double ratio = shader::kHistoryBias * other * bias / variance * (own + other) / (own * other);
    return own + other / (1 + ratio + ratio * ratio);
  };
  for (const auto& [own, other] : {std::pair{4.0, 4.0}, {2.0, 5.0}, {2.0, 20.0}, {16.0, 1.0}})
    EXPECT_NEAR(noisy(own, other).weight, expected(own, other), 1e-3) << own << " " << other;
  EXPECT_EQ(noisy(0, 0).weight, 0);
}

TEST(MergeHistory, RefusesWhatDoesNotFit) {
  MergeHistory op = mergeOf({8, 8});
  op.warped = view(0, DataType::f32, 8, 8, 12);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = mergeOf({8, 8});
  op.sums = view(2, DataType::f32, 7, 8, 12);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  EXPECT_THROW(dispatch(mergeOf({8, 8, 0}), {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::merge_history_test
