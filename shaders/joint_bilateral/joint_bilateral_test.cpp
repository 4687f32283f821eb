#include "shaders/joint_bilateral/joint_bilateral.h"

#include <gtest/gtest.h>

#include "engine/kernel_family.h"
#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::joint_bilateral_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth, scale;  // of the input
  int albedoOffset = 0, normalOffset = 3;
  bool learned = false;
  RowRange rows{};
};

// Odd ones first: one pixel, thin images, rows inside a run and across runs; every scale with and without a network;
// every place of the channels.
constexpr Shape kShapes[] = {{1, 1, 1, 1, 16, 0, 3, true},
                             {1, 1, 8, 8, 4},
                             {1, 9, 8, 16, 2},
                             {9, 1, 16, 8, 8, 0, 3, true},
                             {5, 7, 8, 8, 4, 0, 3, true, {3, 10}},
                             {5, 7, 8, 8, 4, 0, 3, false, {6, 7}},
                             {5, 7, 8, 8, 2, 0, -1, true, {9, 10}},
                             {5, 7, 8, 8, 8, 0, 3, false, {1, 39}},
                             {13, 9, 16, 16, 1},
                             {13, 9, 16, 16, 1, 0, 3, true},
                             {13, 9, 16, 16, 2},
                             {12, 9, 16, 16, 1, 0, 3, true},
                             {12, 9, 16, 16, 1, 0, 3, true, {4, 8}},
                             {14, 9, 16, 16, 2, 0, 3, true},
                             {14, 9, 16, 16, 2, 0, -1, false, {4, 28}},
                             {9, 11, 16, 16, 4},
                             {9, 11, 16, 16, 4, 0, 3, true},
                             {6, 5, 8, 8, 8},
                             {3, 4, 4, 4, 16},
                             {3, 4, 4, 4, 16, 0, 3, true},
                             {5, 6, 8, 8, 4, 3, 0},
                             {5, 6, 8, 8, 4, 6, 1},
                             {5, 6, 8, 8, 4, 5, 8},
                             {5, 6, 8, 8, 4, 9, -1},
                             {5, 6, 8, 8, 2, 2, -1, true}};

JointBilateral bilateralOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  const uint32_t channels = 12, k = s.scale;
  JointBilateral op{.input = view(0, inputType, s.paddedHeight, s.paddedWidth, 4),
                    .aux = view(1, inputType, s.paddedHeight * k, s.paddedWidth * k, channels),
                    .auxMean = view(2, inputType, s.paddedHeight, s.paddedWidth, channels),
                    .output = view(4, outputType, s.height * k, s.width * k, 4),
                    .albedoOffset = s.albedoOffset,
                    .normalOffset = s.normalOffset,
                    .scale = k,
                    .rows = s.rows};
  if (s.learned) op.network = view(3, inputType, s.paddedHeight * k, s.paddedWidth * k, 28);
  return op;
}

// Logits beyond the clamp on both sides; the rest is random in [-1, 1), which gives likenesses from 1 to 0.
test::Contents contentsOf(const JointBilateral& op) {
  if (!op.network.exists()) return {};
  auto logits = test::randomNumbers(op.network.pixelCount() * 28, 9);
  for (float& logit : logits) logit *= 10;
  return {{3, logits}};
}

class JointBilateralShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType>> {};

TEST_P(JointBilateralShapes, MatchesReference) {
  const auto& [s, inputType, outputType] = GetParam();
  const JointBilateral op = bilateralOf(s, inputType, outputType);
  test::expectMatchesReference(op, contentsOf(op));
}

INSTANTIATE_TEST_SUITE_P(All, JointBilateralShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

// Of four pixels where subgroups take turns, if the rows are such; else inside one low-resolution pixel.
TEST(JointBilateral, MakesRunsOfSeveralLowResolutionPixels) {
  const auto runOn = [](const DeviceTraits& device, uint32_t scale, RowRange rows) {
    const JointBilateral op = bilateralOf({16, 8, 16, 8, scale, 0, 3, true, rows});
    return dispatch(op, device).specialization.at(1);
  };
  const DeviceTraits turns = usualTraits(KernelFamily::lane);
  EXPECT_EQ(runOn(turns, 1, {8, 12}), 4u);
  EXPECT_EQ(runOn(turns, 1, {8, 14}), 2u);
  EXPECT_EQ(runOn(turns, 2, {0, 16}), 4u);
  EXPECT_EQ(runOn(turns, 2, {2, 16}), 2u);
  EXPECT_EQ(runOn(turns, 8, {0, 16}), 4u);
  DeviceTraits gpu = usualTraits(KernelFamily::tile);
  EXPECT_EQ(runOn(gpu, 1, {0, 16}), 1u);
  EXPECT_EQ(runOn(gpu, 2, {0, 16}), 2u);
  EXPECT_EQ(runOn(gpu, 4, {0, 16}), 4u);
  gpu.registers = 128;
  EXPECT_EQ(runOn(gpu, 4, {0, 16}), 2u);
}

TEST(JointBilateral, MatchesReferenceWhereRegistersAreFew) {
  DeviceTraits traits = test::traitsOf(KernelFamily::tile);
  traits.registers = 128;
  for (const uint32_t scale : {4u, 8u}) {
    const JointBilateral op = bilateralOf({5, 6, 8, 8, scale, 0, 3, true});
    test::expectMatchesReference(op, traits, test::toleranceOf(DataType::f32), contentsOf(op));
  }
}

TEST(JointBilateral, ReadsAndWritesSlices) {
  JointBilateral op = bilateralOf({3, 5, 4, 8, 2, 0, 3, true});
  op.input = view(0, DataType::f32, 4, 8, 4, 4, 12);
  op.aux = view(1, DataType::f32, 8, 16, 8, 8, 16);
  op.auxMean = view(2, DataType::f32, 4, 8, 8, 4, 16);
  op.network = view(3, DataType::f32, 8, 16, 28, 4, 36);
  op.output = view(4, DataType::f32, 6, 10, 4, 4, 12);
  test::expectMatchesReference(op);
}

TEST(JointBilateral, KeepsAConstantImageWhateverTheGuide) {
  const JointBilateral op = bilateralOf({3, 4, 3, 4, 4});
  HostMemory memory;
  for (double& value : memory.storage(op.input)) value = 0.75;
  const auto guide = test::randomNumbers(memory.storage(op.aux).size(), 3);
  memory.storage(op.aux).assign(guide.begin(), guide.end());
  reference(op, memory);
  for (uint32_t y = 0; y < 12; ++y)
    for (uint32_t x = 0; x < 16; ++x) {
      for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(memory.at(op.output, y, x, c), 0.75, 1e-12);
      EXPECT_EQ(memory.at(op.output, y, x, 3), 0);
    }
}

// A black and a white half of the albedo, each of its own colour: the edge stays where the albedo has it, inside of a
// low-resolution pixel.
TEST(JointBilateral, FollowsTheEdgeOfTheGuide) {
  JointBilateral op = bilateralOf({1, 6, 1, 6, 4, 0, -1});
  HostMemory memory;
  for (uint32_t x = 0; x < 6; ++x)
    for (uint32_t c = 0; c < 3; ++c) {
      memory.at(op.auxMean, 0, x, c) = x < 3 ? 0 : 4;
      memory.at(op.input, 0, x, c) = x < 3 ? 1 : 2;
    }
  for (uint32_t y = 0; y < 4; ++y)
    for (uint32_t x = 10; x < 24; ++x)
      for (uint32_t c = 0; c < 3; ++c) memory.at(op.aux, y, x, c) = 4;
  reference(op, memory);
  for (uint32_t x = 4; x < 20; ++x) EXPECT_NEAR(memory.at(op.output, 1, x, 0), x < 10 ? 1 : 2, 1e-2) << x;
}

TEST(JointBilateral, RefusesWhatDoesNotFit) {
  JointBilateral op = bilateralOf({4, 4, 4, 4, 4});
  op.albedoOffset = -1;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op.albedoOffset = 10;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = bilateralOf({4, 4, 4, 4, 4, 0, 3, true});
  op.network.channels = op.network.channelStride = 24;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  EXPECT_THROW(dispatch(bilateralOf({4, 4, 3, 4, 4}), {}), std::logic_error);
  EXPECT_THROW(dispatch(bilateralOf({4, 4, 4, 4, 3}), {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::joint_bilateral_test
