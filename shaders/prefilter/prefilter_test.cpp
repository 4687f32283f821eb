#include "shaders/prefilter/prefilter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::prefilter_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth, levels, channels = 8;
  int albedoOffset = 0, normalOffset = 3;
  uint32_t transfer = shader::kTransferLog1p;
  RowRange rows{};
};

// Odd ones first: one pixel, thin images, taps far outside of small ones, padding that must not be read, rows of some.
constexpr Shape kShapes[] = {{1, 1, 8, 8, 3},
                             {1, 9, 8, 16, 3},
                             {9, 1, 16, 8, 2},
                             {5, 7, 8, 8, 1},
                             {13, 9, 16, 16, 3, 8, 0, 3, shader::kTransferLog1p, {3, 10}},
                             {13, 9, 16, 16, 2, 12, 3, 0},
                             {13, 9, 16, 16, 3, 12, 6, 1},
                             {13, 9, 13, 9, 2, 4, 0, -1},
                             {13, 9, 13, 9, 3, 8, 2, -1, shader::kTransferNone},
                             {33, 37, 40, 40, 3}};

Prefilter prefilterOf(const Shape& s, DataType logitType = DataType::f32, DataType outputType = DataType::f32) {
  Prefilter op{.colour = view(0, DataType::f32, s.height, s.width, 4),
               .auxMean = view(1, DataType::f32, s.paddedHeight, s.paddedWidth, s.channels),
               .logits = view(3, logitType, s.paddedHeight, s.paddedWidth, alignUp(25 * s.levels, 4u)),
               .exposure = view(4, DataType::f32, 1, 1, 4),
               .output = view(5, outputType, s.height, s.width, 4),
               .levels = s.levels,
               .albedoOffset = s.albedoOffset,
               .normalOffset = s.normalOffset,
               .transfer = static_cast<Transfer>(s.transfer),
               .rows = s.rows};
  if (s.levels > 1) op.coarser = view(2, DataType::f32, s.height, s.width, (s.levels - 1) * (4 + s.channels));
  return op;
}

std::vector<float> positive(uint64_t count, uint32_t seed, float factor = 1) {
  std::vector<float> numbers = test::randomNumbers(count, seed);
  for (float& number : numbers) number = factor * (std::abs(number) + 0.05f);
  return numbers;
}

// Logits beyond the clamp on both sides, some colours below 0.
test::Contents contentsOf(const Prefilter& op) {
  test::Contents contents{{1, positive(op.auxMean.storedElementCount(), 5)}, {4, {1.5f, 1 / 1.5f, 0, 0}}};
  if (op.coarser.exists()) contents[2] = positive(op.coarser.storedElementCount(), 7);
  contents[0] = positive(op.colour.storedElementCount(), 6, 9);
  for (size_t i = 0; i < contents[0].size(); i += 5) contents[0][i] = -contents[0][i];
  contents[3] = test::randomNumbers(op.logits.storedElementCount(), 9);
  for (float& logit : contents[3]) logit *= 10;
  return contents;
}

class PrefilterShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType>> {};

TEST_P(PrefilterShapes, MatchesReference) {
  const auto& [s, logitType, outputType] = GetParam();
  const Prefilter op = prefilterOf(s, logitType, outputType);
  test::expectMatchesReference(op, contentsOf(op));
}

INSTANTIATE_TEST_SUITE_P(All, PrefilterShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

// Radiance near the largest float, of which sums would not be one.
TEST(Prefilter, AddsUpTheLargestRadiances) {
  const Prefilter op = prefilterOf({5, 7, 8, 8, 3});
  test::Contents contents = contentsOf(op);
  for (float& value : contents[0]) value = std::abs(value) * 3e37f;
  for (size_t i = 0; i < contents[2].size(); ++i)
    if (i % 12 < 4) contents[2][i] *= 3e38f;
  test::expectMatchesReference(op, contents);
}

// An evenly lit surface of any albedo stays one: the quotient of the means is the light, whatever the weights.
TEST(Prefilter, KeepsTheLightOfATexture) {
  const Prefilter op = prefilterOf({9, 9, 9, 9, 1, 4, 0, -1});
  HostMemory memory;
  const auto albedo = positive(op.auxMean.storedElementCount(), 3), logits = test::randomNumbers(81 * 28, 4);
  memory.storage(op.auxMean).assign(albedo.begin(), albedo.end());
  memory.storage(op.logits).assign(logits.begin(), logits.end());
  for (uint32_t i = 0; i < 9 * 9 * 4; ++i) memory.storage(op.colour)[i] = 3 * (albedo[i] + shader::kAlbedoEpsilon);
  memory.storage(op.exposure) = {0.5, 2, 0, 0};
  reference(op, memory);
  for (uint32_t y = 0; y < 9; ++y)
    for (uint32_t x = 0; x < 9; ++x) EXPECT_NEAR(memory.at(op.output, y, x, 1), std::log1p(1.5), 1e-6);
}

// One logit that stands out picks its tap; outside of the image that is the border.
TEST(Prefilter, PicksTheTapOfTheLargestLogit) {
  const Prefilter op = prefilterOf({20, 20, 20, 20, 3, 4, 0, -1, shader::kTransferNone});
  HostMemory memory;
  for (uint32_t y = 0; y < 20; ++y)
    for (uint32_t x = 0; x < 20; ++x)
      for (uint32_t level = 0; level < 3; ++level) {
        const TensorView colour = level == 0 ? op.colour : slice(op.coarser, (level - 1) * 8, 4);
        const TensorView aux = level == 0 ? op.auxMean : slice(op.coarser, (level - 1) * 8 + 4, 4);
        for (uint32_t c = 0; c < 3; ++c) {
          memory.at(colour, y, x, c) = 1000 * level + 20 * y + x;
          memory.at(aux, y, x, c) = 1 - shader::kAlbedoEpsilon;
        }
      }
  memory.storage(op.exposure) = {1, 1, 0, 0};
  for (uint32_t tap = 0; tap < 75; ++tap) {
    for (uint32_t c = 0; c < 75; ++c) memory.at(op.logits, 4, 9, c) = c == tap ? 100 : -100;
    reference(op, memory);
    const int step = static_cast<int>(std::lround(std::pow(3, tap / 25)));
    const int y = std::clamp(4 + step * (static_cast<int>(tap) % 25 / 5 - 2), 0, 19),
              x = std::clamp(9 + step * (static_cast<int>(tap) % 5 - 2), 0, 19);
    EXPECT_NEAR(memory.at(op.output, 4, 9, 0), 1000 * (tap / 25) + 20 * y + x, 0.2) << tap;
  }
}

TEST(Prefilter, RefusesWhatDoesNotFit) {
  EXPECT_THROW(dispatch(prefilterOf({8, 8, 8, 7, 1}), {}), std::logic_error);
  EXPECT_THROW(dispatch(prefilterOf({8, 8, 8, 8, 4}), {}), std::logic_error);
  EXPECT_THROW(dispatch(prefilterOf({8, 8, 8, 8, 1, 8, -1, 3}), {}), std::logic_error);
  EXPECT_THROW(dispatch(prefilterOf({8, 8, 8, 8, 1, 8, 0, 6}), {}), std::logic_error);
  Prefilter op = prefilterOf({8, 8, 8, 8, 2});
  op.coarser = {};
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = prefilterOf({8, 8, 8, 8, 2});
  op.logits = view(3, DataType::f32, 8, 8, 28);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::prefilter_test
