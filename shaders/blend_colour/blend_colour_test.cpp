#include "shaders/blend_colour/blend_colour.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::blend_colour_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth, kernelSide, firstLogit;
  int colourOffset = 6, albedoOffset = 0;
  uint32_t transfer = shader::kTransferLog1p;
  RowRange rows{};
};

// Odd ones first: one pixel of a padded image, thin images, rows that no run divides; then every place of the channels.
constexpr Shape kShapes[] = {{1, 1, 8, 8, 5, 53},
                             {1, 9, 1, 9, 3, 3},
                             {9, 1, 16, 8, 5, 28},
                             {9, 13, 16, 16, 5, 53, 6, 0, shader::kTransferLog1p, {4, 7}},
                             {9, 13, 9, 13, 3, 12, 3, 6},
                             {11, 13, 12, 16, 5, 30, 0, 3, shader::kTransferNone},
                             {10, 6, 12, 8, 3, 5, 1, 7, shader::kTransferLog1p, {5, 10}},
                             {33, 37, 40, 40, 5, 53}};

BlendColour blendOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  const uint32_t logits = alignUp(s.firstLogit + s.kernelSide * s.kernelSide + 1, 4u);
  return {.base = view(0, DataType::f32, s.paddedHeight, s.paddedWidth, 4),
          .images = view(1, DataType::f32, s.height, s.width, 12),
          .aux = view(2, inputType, s.paddedHeight, s.paddedWidth, 12),
          .network = view(3, inputType, s.paddedHeight, s.paddedWidth, logits),
          .exposure = view(4, DataType::f32, 1, 1, 4),
          .output = view(5, outputType, s.height, s.width, 4),
          .colourOffset = s.colourOffset,
          .albedoOffset = s.albedoOffset,
          .kernelSide = s.kernelSide,
          .firstLogit = s.firstLogit,
          .transfer = static_cast<Transfer>(s.transfer),
          .rows = s.rows};
}

// Logits beyond the clamp on both sides, some colours below 0.
test::Contents contentsOf(const BlendColour& op, float factor = 5) {
  test::Contents contents{{4, {1.5f, 1 / 1.5f, 0, 0}}};
  contents[1] = test::randomNumbers(op.images.storedElementCount(), 5);
  for (float& value : contents[1]) value *= factor;
  contents[2] = test::randomNumbers(op.aux.storedElementCount(), 6);
  for (float& value : contents[2]) value = std::abs(value);
  contents[3] = test::randomNumbers(op.network.storedElementCount(), 9);
  for (float& logit : contents[3]) logit *= 10;
  return contents;
}

class BlendColourShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType>> {};

TEST_P(BlendColourShapes, MatchesReference) {
  const auto& [s, inputType, outputType] = GetParam();
  const BlendColour op = blendOf(s, inputType, outputType);
  test::expectMatchesReference(op, contentsOf(op));
}

INSTANTIATE_TEST_SUITE_P(All, BlendColourShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

// Radiance near the largest float, of which sums would not be one.
TEST(BlendColour, AddsUpTheLargestRadiances) {
  const BlendColour op = blendOf({9, 13, 16, 16, 5, 53});
  test::expectMatchesReference(op, contentsOf(op, 3e38f));
}

TEST(BlendColour, BlendsByTheSigmoidOfTheLastLogit) {
  const BlendColour op = blendOf({1, 1, 1, 1, 3, 3, 6, 0, shader::kTransferNone});
  HostMemory memory;
  for (uint32_t c = 0; c < 3; ++c) {
    memory.at(op.base, 0, 0, c) = 10;
    memory.at(op.images, 0, 0, 6 + c) = 4;
    memory.at(op.aux, 0, 0, c) = 0.5 - shader::kAlbedoEpsilon;
  }
  memory.storage(op.exposure) = {2, 0.5, 0, 0};
  for (const double logit : {-30.0, -1.0, 0.0, 3.0, 30.0}) {
    memory.at(op.network, 0, 0, 12) = logit;
    reference(op, memory);
    EXPECT_NEAR(memory.at(op.output, 0, 0, 1), 10 + (16 - 10) / (1 + std::exp(-logit)), 1e-6) << logit;
  }
}

TEST(BlendColour, RefusesWhatDoesNotFit) {
  EXPECT_THROW(dispatch(blendOf({8, 8, 8, 7, 3, 3}), {}), std::logic_error);
  EXPECT_THROW(dispatch(blendOf({8, 8, 8, 8, 4, 3}), {}), std::logic_error);
  EXPECT_THROW(dispatch(blendOf({8, 8, 8, 8, 3, 3, 10, 0}), {}), std::logic_error);
  EXPECT_THROW(dispatch(blendOf({8, 8, 8, 8, 3, 3, 6, -1}), {}), std::logic_error);
  BlendColour op = blendOf({8, 8, 8, 8, 3, 3});
  op.network = view(3, DataType::f32, 8, 8, 12);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::blend_colour_test
