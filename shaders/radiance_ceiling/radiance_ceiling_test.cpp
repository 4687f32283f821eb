#include "shaders/radiance_ceiling/radiance_ceiling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::radiance_ceiling_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth;
  Transfer transfer = Transfer::log1p;
  RowRange rows{};
};

// Odd ones first: one pixel, thinner than the reach, rows, padding that must not be read.
constexpr Shape kShapes[] = {{1, 1, 8, 8},
                             {1, 37, 4, 40},
                             {9, 2, 9, 2, Transfer::none},
                             {11, 13, 16, 16, Transfer::log1p, {3, 8}},
                             {33, 35, 40, 40, Transfer::none},
                             {48, 64, 48, 64}};

RadianceCeiling ceilingOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.input = view(0, inputType, s.paddedHeight, s.paddedWidth, 4),
          .output = view(1, outputType, s.height, s.width, 4, 4, 12),
          .transfer = s.transfer,
          .rows = s.rows};
}

// Mostly black with spots, the first pixel one of them, and padding brighter than all.
test::Contents contentsOf(const Shape& s) {
  auto x = test::randomNumbers(size_t{s.paddedHeight} * s.paddedWidth * 4, 5);
  for (size_t i = 0; i < x.size(); ++i) {
    const size_t pixel = i / 4, row = pixel / s.paddedWidth, column = pixel % s.paddedWidth;
    x[i] = row >= s.height || column >= s.width ? 50.f : std::max(0.f, 20 * x[i] - 16);
  }
  x[0] = x[2] = 1;
  return {{0, x}};
}

class RadianceCeilingShapes : public testing::TestWithParam<std::tuple<Shape, KernelFamily, DataType, DataType>> {};

TEST_P(RadianceCeilingShapes, MatchesReference) {
  const auto& [s, family, inputType, outputType] = GetParam();
  test::expectMatchesReference(ceilingOf(s, inputType, outputType), test::traitsOf(family),
                               test::toleranceOf(outputType), contentsOf(s));
}

INSTANTIATE_TEST_SUITE_P(All, RadianceCeilingShapes,
                         testing::Combine(testing::ValuesIn(kShapes),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane),
                                          testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

// Radiance g times the largest around, to a few units in the last place from the smallest number to the largest.
TEST(RadianceCeiling, IsAccurateAtEveryMagnitude) {
  const Shape shape{4, 32, 4, 32};
  const RadianceCeiling op = ceilingOf(shape);
  for (int exponent = -100; exponent < 7; ++exponent) {
    auto x = test::randomNumbers(4 * 32 * 4, static_cast<uint32_t>(exponent + 200));
    for (float& value : x) value = std::ldexp(1.5f + 0.5f * value, exponent);
    test::expectMatchesReference(op, test::gpu().traits(), {1e-6, 3e-6}, {{0, x}});
  }
}

TEST(RadianceCeiling, OfOnePixelReachesTwoPixelsFar) {
  const RadianceCeiling op = ceilingOf({9, 9, 9, 9});
  HostMemory memory;
  memory.at(op.input, 4, 5, 1) = std::log1p(3.0);
  reference(op, memory);
  for (uint32_t y = 0; y < 9; ++y)
    for (uint32_t x = 0; x < 9; ++x)
      for (uint32_t c = 0; c < 4; ++c) {
        const bool near = y >= 2 && y <= 6 && x >= 3 && x <= 7 && c == 1;
        EXPECT_NEAR(std::expm1(memory.at(op.output, y, x, c)), near ? 3 * shader::kCeilingFactor : 0, 1e-12);
      }
}

TEST(RadianceCeiling, RefusesWhatDoesNotFit) {
  EXPECT_THROW(dispatch(ceilingOf({9, 8, 8, 8}), {}), std::logic_error);
  RadianceCeiling op = ceilingOf({4, 4, 8, 8});
  op.output.channels = 3;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::radiance_ceiling_test
