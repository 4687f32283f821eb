#include "shaders/filter_auxiliary/filter_auxiliary.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::filter_auxiliary_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth, channels, kernelSide, firstLogit, networkChannels;
  RowRange rows{};
};

// Odd ones first: one pixel of a padded image and of one that is not, thin images, rows that no run divides; then every
// width, side and place of the logits.
constexpr Shape kShapes[] = {{1, 1, 8, 8, 8, 3, 3, 12},
                             {1, 1, 1, 1, 4, 5, 3, 28},
                             {1, 9, 1, 9, 8, 3, 28, 40},
                             {9, 1, 16, 8, 8, 5, 28, 56},
                             {9, 13, 16, 16, 8, 5, 28, 56, {4, 7}},
                             {9, 13, 16, 16, 12, 3, 3, 12, {6, 7}},
                             {9, 13, 9, 13, 8, 5, 7, 32, {3, 9}},
                             {11, 13, 11, 13, 24, 3, 5, 16},
                             {11, 13, 11, 13, 4, 3, 4, 16},
                             {10, 6, 12, 8, 12, 5, 6, 32, {5, 10}},
                             {7, 5, 8, 8, 4, 1, 3, 4},
                             {33, 37, 40, 40, 8, 3, 28, 40},
                             {64, 64, 64, 64, 8, 5, 28, 56}};

FilterAuxiliary filterOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.aux = view(0, inputType, s.paddedHeight, s.paddedWidth, s.channels),
          .network = view(1, inputType, s.paddedHeight, s.paddedWidth, s.networkChannels),
          .output = view(2, outputType, s.height, s.width, s.channels),
          .kernelSide = s.kernelSide,
          .firstLogit = s.firstLogit,
          .rows = s.rows};
}

// Logits beyond the clamp on both sides.
test::Contents contentsOf(const FilterAuxiliary& op) {
  auto logits = test::randomNumbers(op.network.pixelCount() * op.network.channels, 9);
  for (float& logit : logits) logit *= 10;
  return {{1, logits}};
}

class FilterAuxiliaryShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType>> {};

TEST_P(FilterAuxiliaryShapes, MatchesReference) {
  const auto& [s, inputType, outputType] = GetParam();
  const FilterAuxiliary op = filterOf(s, inputType, outputType);
  test::expectMatchesReference(op, contentsOf(op));
}

INSTANTIATE_TEST_SUITE_P(All, FilterAuxiliaryShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(FilterAuxiliary, ReadsAndWritesSlices) {
  FilterAuxiliary op = filterOf({7, 5, 8, 8, 8, 3, 28, 40});
  op.aux = view(0, DataType::f32, 8, 8, 8, 4, 16);
  op.network = view(1, DataType::f32, 8, 8, 40, 4, 48);
  op.output = view(2, DataType::f32, 7, 5, 8, 8, 20);
  test::expectMatchesReference(op);
}

// One logit that stands out picks its neighbour; outside of the image that is the border, not the padding.
TEST(FilterAuxiliary, PicksTheNeighbourOfTheLargestLogit) {
  const FilterAuxiliary op = filterOf({3, 3, 4, 4, 8, 3, 3, 12});
  HostMemory memory;
  for (uint32_t y = 0; y < 4; ++y)
    for (uint32_t x = 0; x < 4; ++x)
      for (uint32_t c = 0; c < 8; ++c) memory.at(op.aux, y, x, c) = y < 3 && x < 3 ? 3 * y + x + 0.1 * c : 99;
  for (int j = 0; j < 9; ++j) {
    for (uint32_t y = 0; y < 3; ++y)
      for (uint32_t x = 0; x < 3; ++x)
        for (int k = 0; k < 9; ++k) memory.at(op.network, y, x, 3 + k) = k == j ? 100 : -100;
    reference(op, memory);
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 3; ++x) {
        const int expected = 3 * std::clamp(y + j / 3 - 1, 0, 2) + std::clamp(x + j % 3 - 1, 0, 2);
        for (uint32_t c = 0; c < 8; ++c) EXPECT_NEAR(memory.at(op.output, y, x, c), expected + 0.1 * c, 1e-5) << j;
      }
  }
}

TEST(FilterAuxiliary, RefusesWhatDoesNotFit) {
  EXPECT_THROW(dispatch(filterOf({8, 8, 8, 7, 8, 3, 3, 12}), {}), std::logic_error);
  EXPECT_THROW(dispatch(filterOf({8, 8, 8, 8, 8, 3, 3, 8}), {}), std::logic_error);
  EXPECT_THROW(dispatch(filterOf({8, 8, 8, 8, 8, 4, 3, 20}), {}), std::logic_error);
  EXPECT_THROW(dispatch(filterOf({8, 8, 8, 8, 6, 3, 3, 12}), {}), std::logic_error);
  FilterAuxiliary op = filterOf({8, 8, 8, 8, 8, 3, 3, 12});
  op.output.channels = op.output.channelStride = 4;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = filterOf({8, 8, 8, 8, 8, 3, 3, 12});
  op.network = {};
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::filter_auxiliary_test
