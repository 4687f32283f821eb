#include "shaders/pack_auxiliary/pack_auxiliary.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::pack_auxiliary_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, paddedHeight, paddedWidth, channels;
  int albedoOffset = -1;
  RowRange rows{};
  uint32_t inputOffset = 0, inputStride = 0, outputOffset = 0, outputStride = 0;
  int colourOffset = -1;
  bool demodulates = false;
  uint32_t transfer = shader::kTransferLog1p;
  uint32_t lightChannels = 0;
};

// Odd ones first: one pixel padded to many, no padding, the albedo across two texels, slices, rows inside and beyond;
// the colour before and behind the albedo, with and without it; light, beside all of them and alone.
constexpr Shape kShapes[] = {
    {1, 1, 8, 8, 4, 0},
    {5, 7, 8, 8, 8, 0},
    {3, 5, 3, 5, 8},
    {13, 17, 16, 24, 12, 3},
    {13, 17, 16, 24, 12, 6, {3, 11}},
    {9, 31, 16, 32, 12, 9, {9, 16}},
    {6, 6, 8, 8, 8, 5, {0, 1}, 4, 16, 8, 20},
    {64, 64, 64, 64, 8, 0},
    {1, 1, 8, 8, 12, 0, {}, 0, 0, 0, 0, 6, true},
    {13, 17, 16, 24, 12, 3, {}, 0, 0, 0, 0, 0, true},
    {13, 17, 16, 24, 12, 0, {3, 11}, 0, 0, 0, 0, 9, false},
    {13, 17, 16, 24, 12, 0, {}, 0, 0, 0, 0, 5, true, shader::kTransferNone},
    {13, 17, 16, 24, 4, -1, {}, 0, 0, 0, 0, 0, false},
    {7, 5, 8, 8, 12, 3, {}, 0, 0, 0, 0, -1, true, shader::kTransferLog1p, 7u << 9 | 7},
    {7, 5, 8, 8, 16, 0, {2, 7}, 4, 24, 0, 0, 6, true, shader::kTransferLog1p, 7u << 3 | 7u << 12},
    {7, 5, 8, 8, 8, -1, {}, 0, 0, 0, 0, -1, false, shader::kTransferNone, 7u << 5}};

std::vector<float> values(const Shape& s) {
  auto numbers = test::randomNumbers(size_t{s.height} * s.width * (s.inputStride ? s.inputStride : s.channels), 3);
  for (float& number : numbers) number *= 8;  // beyond the clamp on both sides
  return numbers;
}

PackAuxiliary packOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  return {.input = view(0, inputType, s.height, s.width, s.channels, s.inputOffset, s.inputStride),
          .output = view(1, outputType, s.paddedHeight, s.paddedWidth, s.channels, s.outputOffset, s.outputStride),
          .albedoOffset = s.albedoOffset,
          .colourOffset = s.colourOffset,
          .lightChannels = s.lightChannels,
          .exposure = view(2, DataType::f32, 1, 1, 4),
          .demodulates = s.demodulates,
          .transfer = static_cast<Transfer>(s.transfer),
          .rows = s.rows};
}

class PackAuxiliaryShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType>> {};

TEST_P(PackAuxiliaryShapes, MatchesReference) {
  const auto& [s, inputType, outputType] = GetParam();
  test::expectMatchesReference(packOf(s, inputType, outputType), {{0, values(s)}, {2, {1.5f, 1 / 1.5f, 0, 0}}});
}

INSTANTIATE_TEST_SUITE_P(All, PackAuxiliaryShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16)));

TEST(PackAuxiliary, ClampsTheAlbedoOnlyAndRepeatsTheEdge) {
  const PackAuxiliary op = packOf({1, 1, 2, 2, 8, 3});
  HostMemory memory;
  memory.storage(op.input) = {9, -9, 9, 9, -9, 2, 9, -9};
  reference(op, memory);
  const std::vector<double> pixel{9, -9, 9, 4, 0, 2, 9, -9};
  for (uint32_t i = 0; i < 32; ++i) EXPECT_EQ(memory.storage(op.output)[i], pixel[i % 8]);
}

TEST(PackAuxiliary, TransformsTheColourAsTheNetworkSeesIt) {
  PackAuxiliary op = packOf({1, 1, 1, 1, 8, 0, {}, 0, 0, 0, 0, 3, true});
  HostMemory memory;
  memory.storage(op.input) = {0.48, 9, -1, 6, 8, -2, 0, 0};  // the albedo counts as clamped, negative radiance as 0
  memory.storage(op.exposure) = {0.5, 2, 0, 0};
  reference(op, memory);
  EXPECT_NEAR(memory.storage(op.output)[3], std::log1p(0.5 * 6 / 0.5), 1e-7);
  EXPECT_NEAR(memory.storage(op.output)[4], std::log1p(0.5 * 8 / 4.02), 1e-7);
  EXPECT_EQ(memory.storage(op.output)[5], 0);
}

TEST(PackAuxiliary, TransformsLightWithoutTheAlbedo) {
  PackAuxiliary op = packOf({1, 1, 1, 1, 8, 0, {}, 0, 0, 0, 0, 3, true});
  op.lightChannels = 3u << 6;
  HostMemory memory;
  memory.storage(op.input) = {0.48, 0.5, 0.5, 6, 8, 2, 3, -1};
  memory.storage(op.exposure) = {0.5, 2, 0, 0};
  reference(op, memory);
  EXPECT_NEAR(memory.storage(op.output)[6], std::log1p(0.5 * 3), 1e-7);
  EXPECT_EQ(memory.storage(op.output)[7], 0);
}

TEST(PackAuxiliary, KeepsAllElseWithinTheRangeOfAHalf) {
  const Shape shape{4, 4, 4, 4, 8, 0};
  auto numbers = values(shape);
  for (float& number : numbers) number *= 1e30f;
  for (const DataType type : {DataType::f32, DataType::f16})
    test::expectMatchesReference(packOf(shape, DataType::f32, type), {{0, numbers}});
}

TEST(PackAuxiliary, RefusesWhatDoesNotFit) {
  EXPECT_THROW(dispatch(packOf({8, 8, 4, 8, 8, 0}), {}), std::logic_error);
  EXPECT_THROW(dispatch(packOf({8, 8, 8, 8, 8, 6}), {}), std::logic_error);
  EXPECT_THROW(dispatch(packOf({8, 8, 8, 8, 8, 0, {}, 0, 0, 0, 0, 6}), {}), std::logic_error);
  EXPECT_THROW(dispatch(packOf({8, 8, 8, 8, 8, -1, {}, 0, 0, 0, 0, 3, true}), {}), std::logic_error);
  PackAuxiliary op = packOf({8, 8, 8, 8, 8, 0});
  op.lightChannels = 7u << 6;  // one beyond the last channel
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
  op.lightChannels = 0;
  op.output = view(1, DataType::f32, 8, 8, 4);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::pack_auxiliary_test
