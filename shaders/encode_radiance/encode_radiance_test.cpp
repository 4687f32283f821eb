#include "shaders/encode_radiance/encode_radiance.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::encode_radiance_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth;
  Transfer transfer = Transfer::log1p;
  int albedoOffset = -1;
  uint32_t auxChannels = 8;
  RowRange rows{};
  bool reflects = false;
};

// Odd ones first: one pixel padded to a window, no padding, every place of the albedo, rows inside and beyond,
// reflections, also of less than a window.
constexpr Shape kShapes[] = {{1, 1, 8, 8, Transfer::log1p, 0},
                             {5, 7, 8, 8},
                             {9, 13, 9, 13, Transfer::none},
                             {9, 13, 16, 16, Transfer::none, 0},
                             {33, 31, 40, 32, Transfer::log1p, 0},
                             {11, 6, 12, 12, Transfer::log1p, 3},
                             {11, 6, 12, 12, Transfer::log1p, 6, 12, {4, 9}},
                             {11, 6, 16, 12, Transfer::log1p, 9, 12, {11, 16}},
                             {10, 10, 16, 16, Transfer::log1p, 5, 8, {3, 4}},
                             {13, 10, 16, 16, Transfer::none, -1, 8, {}, true},
                             {1, 3, 8, 8, Transfer::log1p, 0, 8, {}, true},
                             {64, 64, 64, 64, Transfer::log1p, 0}};

EncodeRadiance encodeOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {
      .colour = view(0, inputType, s.height, s.width, 4),
      .exposure = view(1, DataType::f32, 1, 1, 4),
      .auxMean = s.albedoOffset < 0 ? TensorView{} : view(2, inputType, s.paddedHeight, s.paddedWidth, s.auxChannels),
      .output = view(3, outputType, s.paddedHeight, s.paddedWidth, 4),
      .albedoOffset = s.albedoOffset,
      .transfer = s.transfer,
      .reflects = s.reflects,
      .rows = s.rows};
}

// Radiances of which every fourth is negative, an exposure and albedos between 0 and 1.
test::Contents contentsOf(const Shape& s) {
  auto colour = test::randomNumbers(size_t{s.height} * s.width * 4, 5);
  for (size_t i = 0; i < colour.size(); ++i) colour[i] = (i % 4 == 3 ? -1.0f : 1.0f) * std::exp(3 * colour[i]);
  auto albedo = test::randomNumbers(size_t{s.paddedHeight} * s.paddedWidth * s.auxChannels, 6);
  for (float& value : albedo) value = 0.5f * value + 0.5f;
  test::Contents contents{{0, colour}, {1, {0.5f, 2, 0, 0}}};
  if (s.albedoOffset >= 0) contents[2] = albedo;
  return contents;
}

class EncodeRadianceShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType>> {};

TEST_P(EncodeRadianceShapes, MatchesReference) {
  const auto& [s, inputType, outputType] = GetParam();
  test::expectMatchesReference(encodeOf(s, inputType, outputType), contentsOf(s));
}

INSTANTIATE_TEST_SUITE_P(All, EncodeRadianceShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(EncodeRadiance, ReadsAndWritesSlices) {
  EncodeRadiance op = encodeOf({3, 5, 4, 8});
  op.colour = view(0, DataType::f32, 3, 5, 4, 4, 12);
  op.exposure = view(1, DataType::f32, 1, 1, 4, 4, 8);
  op.output = view(3, DataType::f32, 4, 8, 4, 8, 20);
  test::expectMatchesReference(op);
}

// log1p keeps its relative accuracy from the smallest radiance to the largest: a few units in the last place.
TEST(EncodeRadiance, IsAccurateAtEveryMagnitude) {
  const EncodeRadiance op = encodeOf({4, 32, 4, 32});
  for (int exponent = -100; exponent < 16; ++exponent) {
    auto colour = test::randomNumbers(4 * 32 * 4, static_cast<uint32_t>(exponent + 200));
    for (float& value : colour) value = std::ldexp(1.5f + 0.5f * value, exponent);
    test::expectMatchesReference(op, test::gpu().traits(), {5e-7, 3e-6}, {{0, colour}, {1, {1, 1, 0, 0}}});
  }
}

// Also where radiance times exposure over albedo is larger than any float.
TEST(EncodeRadiance, NeverOverflows) {
  EncodeRadiance op = encodeOf({4, 32, 4, 32, Transfer::log1p, 0});
  auto colour = test::randomNumbers(4 * 32 * 4, 3), albedo = test::randomNumbers(4 * 32 * 8, 4);
  for (float& value : colour) value = std::exp(44 * value + 44);
  for (float& value : albedo) value = std::max(0.0f, value);
  for (const float exposure : {1e-30f, 1e-6f, 1e6f, 1e30f})
    test::expectMatchesReference(op, test::gpu().traits(), {5e-7, 3e-6},
                                 {{0, colour}, {1, {exposure, 1 / exposure, 0, 0}}, {2, albedo}});
  op.transfer = Transfer::none;
  test::expectMatchesReference(op, {{0, colour}, {1, {1e30f, 1e-30f, 0, 0}}, {2, albedo}});
}

TEST(EncodeRadiance, OfOneIsTheLogarithmOfTwo) {
  EncodeRadiance op = encodeOf({1, 1, 1, 1});
  HostMemory memory;
  memory.storage(op.colour) = {2, -3, 0, 5};
  memory.storage(op.exposure) = {0.5, 2, 0, 0};
  reference(op, memory);
  EXPECT_EQ(memory.storage(op.output), (std::vector<double>{std::log(2.0), 0, 0, 0}));
}

TEST(EncodeRadiance, ReflectsWithoutRepeatingTheEdge) {
  EncodeRadiance op = encodeOf({1, 3, 1, 8, Transfer::none});
  op.reflects = true;
  HostMemory memory;
  memory.storage(op.colour) = {10, 0, 0, 0, 11, 0, 0, 0, 12, 0, 0, 0};
  memory.storage(op.exposure) = {1, 1, 0, 0};
  reference(op, memory);
  const double expected[] = {10, 11, 12, 11, 10, 11, 12, 11};
  for (uint32_t x = 0; x < 8; ++x) EXPECT_EQ(memory.at(op.output, 0, x, 0), expected[x]) << x;
}

TEST(EncodeRadiance, RefusesWhatDoesNotFit) {
  EXPECT_THROW(dispatch(encodeOf({8, 8, 4, 8}), {}), std::logic_error);
  EXPECT_THROW(dispatch(encodeOf({8, 8, 8, 8, Transfer::log1p, 6}), {}), std::logic_error);
  EncodeRadiance op = encodeOf({5, 5, 8, 8, Transfer::log1p, 0});
  op.auxMean = view(2, DataType::f32, 5, 5, 8);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op.auxMean = {};
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::encode_radiance_test
