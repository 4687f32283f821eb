#include "shaders/decode_radiance/decode_radiance.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::decode_radiance_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth;
  Transfer transfer = Transfer::log1p;
  bool base = true;
  int albedoOffset = 0;
  uint32_t networkChannels = 4;
  RowRange rows{};
};

// Odd ones first: one pixel of a padded image, rows, every place of the albedo, with and without base and albedo.
constexpr Shape kShapes[] = {{1, 1, 8, 8},
                             {5, 7, 8, 8, Transfer::log1p, true, 3, 28},
                             {9, 13, 16, 16, Transfer::log1p, true, 6, 4, {4, 7}},
                             {9, 13, 16, 16, Transfer::none, true, 9, 28, {8, 9}},
                             {9, 13, 9, 13, Transfer::log1p, false, -1},
                             {9, 13, 9, 13, Transfer::none, false, -1, 8},
                             {12, 20, 16, 32, Transfer::log1p, true, -1},
                             {12, 20, 16, 32, Transfer::none, true, -1},
                             {12, 20, 16, 32, Transfer::none, false, 0},
                             {64, 64, 64, 64}};

DecodeRadiance decodeOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.network = view(0, inputType, s.paddedHeight, s.paddedWidth, s.networkChannels),
          .base = s.base ? view(1, inputType, s.height, s.width, 4) : TensorView{},
          .aux = s.albedoOffset < 0 ? TensorView{} : view(2, inputType, s.paddedHeight, s.paddedWidth, 12),
          .exposure = view(3, DataType::f32, 1, 1, 4),
          .output = view(4, outputType, s.height, s.width, 4),
          .albedoOffset = s.albedoOffset,
          .transfer = s.transfer,
          .rows = s.rows};
}

// A base in [-1.5, 6.5), so that sums fall below 0 and a residual of 8 reaches beyond 11; e = 4.
test::Contents contentsOf(const DecodeRadiance& op) {
  test::Contents contents{{3, {4, 0.25f, 0, 0}}};
  if (!op.base.exists()) return contents;
  contents[1] = test::randomNumbers(op.base.pixelCount() * 4, 8);
  for (float& value : contents[1]) value = 4 * value + 2.5f;
  return contents;
}

class DecodeRadianceShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType>> {};

TEST_P(DecodeRadianceShapes, MatchesReference) {
  const auto& [s, inputType, outputType] = GetParam();
  const DecodeRadiance op = decodeOf(s, inputType, outputType);
  test::expectMatchesReference(op, contentsOf(op));
}

INSTANTIATE_TEST_SUITE_P(All, DecodeRadianceShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(DecodeRadiance, ReadsAndWritesSlices) {
  DecodeRadiance op = decodeOf({3, 5, 4, 8});
  op.network = view(0, DataType::f32, 4, 8, 4, 8, 16);
  op.base = view(1, DataType::f32, 3, 5, 4, 4, 12);
  op.aux = view(2, DataType::f32, 4, 8, 8, 4, 12);
  op.exposure = view(3, DataType::f32, 1, 1, 4, 4, 8);
  op.output = view(4, DataType::f32, 3, 5, 4, 4, 8);
  test::expectMatchesReference(op, {{3, {9, 9, 9, 9, 2, 0.5f, 0, 0}}});
}

TEST(DecodeRadiance, ClampsWhatIsAddedToABase) {
  const DecodeRadiance op = decodeOf({4, 16, 4, 16});
  auto contents = contentsOf(op);
  contents[0] = test::randomNumbers(4 * 16 * 4, 2);
  for (float& value : contents[0]) value *= 30;
  test::expectMatchesReference(op, contents);
}

// Ceilings between 0 and 12 over a residual of either sign, pixels of the output that share one.
TEST(DecodeRadiance, KeepsTheNetworkBelowTheCeiling) {
  for (const uint32_t scale : {1u, 4u}) {
    DecodeRadiance op = decodeOf({12, 20, 16, 32});
    op.ceiling = view(5, DataType::f32, 4 * 4 / scale, 8 * 4 / scale, 4);
    op.scale = scale;
    auto contents = contentsOf(op);
    contents[0] = test::randomNumbers(16 * 32 * 4, 2);
    for (float& value : contents[0]) value *= 10;
    contents[5] = test::randomNumbers(op.ceiling.pixelCount() * 4, 9);
    for (float& value : contents[5]) value = std::max(0.f, 12 * value);
    test::expectMatchesReference(op, contents);
  }
}

// Where nothing around is lit, nothing comes out, whatever the network says.
TEST(DecodeRadiance, IsBlackUnderACeilingOfZero) {
  DecodeRadiance op = decodeOf({2, 4, 2, 4});
  op.ceiling = view(5, DataType::f32, 1, 2, 4);
  op.scale = 2;
  HostMemory memory;
  memory.storage(op.exposure) = {1, 1, 0, 0};
  for (double& value : memory.storage(op.network)) value = 3;
  memory.at(op.ceiling, 0, 1, 1) = 2;
  reference(op, memory);
  for (uint32_t y = 0; y < 2; ++y)
    for (uint32_t x = 0; x < 4; ++x)
      for (uint32_t c = 0; c < 3; ++c) EXPECT_EQ(memory.at(op.output, y, x, c) > 0, x >= 2 && c == 1);
}

TEST(DecodeRadiance, NeverClampsTheBaseItself) {
  const DecodeRadiance op = decodeOf({1, 4, 1, 4, Transfer::log1p, true, -1});
  HostMemory memory;
  memory.storage(op.exposure) = {1, 1, 0, 0};
  memory.storage(op.base) = {20, 20, 20, 0, 10, 10, 10, 0, 20, 20, 20, 0, 5, 5, 5, 0};
  memory.storage(op.network) = {1, -1, 0, 0, 5, 0, -20, 0, -15, 0, 0, 0, 1, 0, 0, 0};
  reference(op, memory);
  const double expected[] = {20, 19, 20, 11, 10, 0, 5, 20, 20, 6, 5, 5};
  for (uint32_t i = 0; i < 12; ++i)
    EXPECT_NEAR(std::log1p(memory.at(op.output, 0, i / 3, i % 3)), expected[i], 1e-12) << i;
}

// Highlights whose encoding, decoded alone, is larger than any float.
TEST(DecodeRadiance, NeverOverflows) {
  DecodeRadiance op = decodeOf({4, 32, 4, 32, Transfer::log1p, true, 0});
  auto base = test::randomNumbers(4 * 32 * 4, 3);
  for (float& value : base) value = 90 * value + 90;
  auto albedo = test::randomNumbers(4 * 32 * 12, 4);
  for (float& value : albedo) value = 2 * value + 2;
  for (const float exposure : {1e-30f, 1.f, 1e30f})
    test::expectMatchesReference(op, test::gpu().traits(), {1e-4, 1e-3},
                                 {{1, base}, {2, albedo}, {3, {exposure, 1 / exposure, 0, 0}}});
  op.transfer = Transfer::none;
  for (float& value : base) value *= 1e16f;
  test::expectMatchesReference(op, {{1, base}, {2, albedo}, {3, {1e-30f, 1e30f, 0, 0}}});
}

// Colours of the size of the result, some of them negative, in a slice of another tensor.
TEST(DecodeRadiance, TakesSharesOfWhatChangesInAColour) {
  for (const Shape& s : {Shape{9, 13, 16, 16, Transfer::log1p, true, 6, 4, {4, 8}}, Shape{64, 64, 64, 64}}) {
    DecodeRadiance op = decodeOf(s);
    op.colour = view(5, DataType::f32, s.height, s.width, 4, 4, 12);
    op.darker = 0.75F;
    op.brighter = 0.25F;
    auto contents = contentsOf(op);
    contents[5] = test::randomNumbers(op.colour.pixelCount() * 12, 6);
    for (float& value : contents[5]) value = 20 * value + 10;
    test::expectMatchesReference(op, contents);
  }
}

TEST(DecodeRadiance, DarkensAndBrightensAColourByItsShares) {
  DecodeRadiance op = decodeOf({1, 4, 1, 4, Transfer::none, false, -1});
  op.colour = view(5, DataType::f32, 1, 4, 4);
  op.darker = 0.75F;
  op.brighter = 0.25F;
  HostMemory memory;
  memory.storage(op.exposure) = {1, 1, 0, 0};
  memory.storage(op.network) = {1, 5, 2, 0, 0, 3, 1e30, 0, 2, 2, 2, 0, 0, 0, 0, 0};
  memory.storage(op.colour) = {5, 1, 2, 0, 1, -1, 0, 0, 2, 2, 2, 0, 0, 0, 0, 0};
  reference(op, memory);
  const double expected[] = {2, 2, 2, 0.25, 0.75, 2.5e29, 2, 2, 2, 0, 0, 0};
  for (uint32_t i = 0; i < 12; ++i) {
    const double found = memory.at(op.output, 0, i / 3, i % 3);
    EXPECT_NEAR(found, expected[i], 1e-12 * std::max(1.0, found)) << i;
  }
}

TEST(DecodeRadiance, LeavesOutANetworkThatIsNotFinite) {
  const DecodeRadiance op = decodeOf({4, 32, 4, 32});
  auto contents = contentsOf(op);
  contents[0] = test::randomNumbers(4 * 32 * 4, 2);
  for (size_t i = 0; i < contents[0].size(); i += 20) contents[0][i + i / 20 % 3] = i % 40 == 0 ? NAN : INFINITY;
  test::expectMatchesReference(op, contents);
}

// expm1 keeps its relative accuracy from the smallest radiance to the largest.
TEST(DecodeRadiance, IsAccurateAtEveryMagnitude) {
  const DecodeRadiance op = decodeOf({4, 32, 4, 32, Transfer::log1p, false, -1});
  for (int exponent = -100; exponent < 4; ++exponent)
    for (const int sign : {-1, 1}) {
      auto values = test::randomNumbers(4 * 32 * 4, static_cast<uint32_t>(exponent + 200));
      for (float& value : values) value = static_cast<float>(sign) * std::ldexp(1.375f + 0.375f * value, exponent);
      test::expectMatchesReference(op, test::gpu().traits(), {2e-6, 1e-5}, {{0, values}, {3, {1, 1, 0, 0}}});
    }
}

// T(e I / (a + 0.02)) as the base and no residual give I back.
TEST(DecodeRadiance, InvertsTheEncoding) {
  const DecodeRadiance op = decodeOf({2, 3, 2, 3});
  HostMemory memory;
  memory.storage(op.exposure) = {0.25, 4, 0, 0};
  const auto colour = test::randomNumbers(24, 1), albedo = test::randomNumbers(24, 2);
  const auto radiance = [&](uint32_t i, uint32_t c) { return std::abs(colour[4 * i + c]); };
  for (uint32_t i = 0; i < 6; ++i)
    for (uint32_t c = 0; c < 3; ++c) {
      double& a = memory.at(op.aux, i / 3, i % 3, c) = std::abs(albedo[4 * i + c]);
      memory.at(op.base, i / 3, i % 3, c) =
          transform(op.transfer, 0.25 * radiance(i, c) / (a + shader::kAlbedoEpsilon));
    }
  reference(op, memory);
  for (uint32_t i = 0; i < 6; ++i)
    for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(memory.at(op.output, i / 3, i % 3, c), radiance(i, c), 1e-12);
}

TEST(DecodeRadiance, TakesAbsentNetworkAsZero) {
  DecodeRadiance op = decodeOf({7, 5, 8, 8});
  op.network = {};
  test::expectMatchesReference(op, {{3, {0.5, 2, 0, 0}}});
}

TEST(DecodeRadiance, RefusesWhatDoesNotFit) {
  DecodeRadiance op = decodeOf({8, 8, 8, 8});
  op.aux = {};
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = decodeOf({8, 8, 8, 8});
  op.albedoOffset = 10;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = decodeOf({8, 8, 8, 8});
  op.base.height = 7;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  EXPECT_THROW(dispatch(decodeOf({8, 8, 8, 7}), {}), std::logic_error);
  op = decodeOf({8, 8, 8, 8});
  op.ceiling = view(5, DataType::f32, 2, 1, 4);
  op.scale = 4;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = decodeOf({8, 8, 8, 8});
  op.colour = view(5, DataType::f32, 8, 7, 4);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op = decodeOf({8, 8, 8, 8});
  op.network = op.base = {};
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::decode_radiance_test
