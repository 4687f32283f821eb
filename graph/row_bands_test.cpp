// Every operator on tensors of which only a band of rows is stored, and on rows taken as an image of their own.
#include <gtest/gtest.h>

#include "graph/graph.h"
#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds {
namespace {

using test::expectMatchesReference;
using test::randomNumbers;
using test::toleranceOf;
using test::view;

// A view of an image of which the rows alone are stored.
TensorView band(TensorView image, RowRange rows) {
  image.firstRow = static_cast<int32_t>(rows.begin);
  image.storedHeight = rows.end - rows.begin;
  return image;
}

class Band : public testing::TestWithParam<std::tuple<DataType, KernelFamily>> {
 protected:
  DataType type() const { return std::get<0>(GetParam()); }
  template <class Op>
  void expectMatch(const Op& op, const test::Contents& contents = {}) {
    DeviceTraits traits = test::gpu().traits();
    traits.family = std::get<1>(GetParam());
    expectMatchesReference(op, traits, toleranceOf(type()), contents);
  }
};

TEST_P(Band, Conv3x3) {
  const auto weight = randomNumbers(size_t{16} * 8 * 9, 1), bias = randomNumbers(16, 2);
  Conv3x3 op{.weight = weight, .bias = bias, .inputChannels = 8, .outputChannels = 16, .weightType = type()};
  op.input = band(view(0, type(), 40, 22, 8, 4, 16), {11, 25});
  op.output = band(view(1, type(), 40, 22, 16), {8, 24});
  op.residual = band(view(2, type(), 40, 22, 16), {12, 30});
  op.rows = {12, 24};
  expectMatch(op);
  op.rows = {0, 8};  // with the zeros above the image
  op.input = band(op.input, {0, 9});
  op.output = op.residual = band(op.output, {0, 10});
  expectMatch(op);
}

TEST_P(Band, Conv3x3BetweenResolutions) {
  const auto weight = randomNumbers(size_t{16} * 16 * 9, 1), bias = randomNumbers(16, 2);
  Conv3x3 op{.weight = weight, .bias = bias, .inputChannels = 16, .outputChannels = 16, .weightType = type()};
  op.unshuffleInput = true;
  op.input = band(view(0, type(), 40, 36, 4), {14, 34});
  op.output = band(view(1, type(), 20, 18, 16), {6, 16});
  op.rows = {8, 16};
  expectMatch(op);
  op.unshuffleInput = false;
  op.shuffleOutput = true;
  op.input = band(view(0, type(), 20, 18, 16), {7, 20});
  op.output = band(view(1, type(), 40, 36, 4), {15, 40});
  op.rows = {8, 20};  // with the zeros below the image
  expectMatch(op);
}

TEST_P(Band, LinearAndLayerNorm) {
  const auto weight = randomNumbers(size_t{8} * 16, 1), bias = randomNumbers(16, 2);
  const TensorView x = band(view(0, type(), 32, 9, 8), {8, 24}), whole = view(1, type(), 32, 9, 16, 4, 24);
  Linear linear{.input = x, .output = whole, .weight = weight, .bias = bias, .weightType = type()};
  linear.rows = {9, 23};
  expectMatch(linear);
  linear.residual = rowsOf(whole, {9, 23});
  linear.input = rowsOf(x, {9, 23});
  linear.output = view(2, type(), 14, 9, 16);
  linear.rows = {};
  expectMatch(linear);
  const auto affine = randomNumbers(8, 3);
  expectMatch(LayerNorm{.input = x,
                        .output = band(view(3, type(), 32, 9, 8), {4, 20}),
                        .weight = affine,
                        .bias = affine,
                        .rows = {8, 20}});
}

TEST_P(Band, WindowAttention) {
  const auto table = randomNumbers(size_t{49} * 2, 1);
  WindowAttention op{.biasTable = table, .window = 4, .headChannels = 8};
  for (const uint32_t shift : {0u, 2u}) {
    const RowRange rows{8 + shift, 16 + shift};
    const TensorView qkv = band(view(0, type(), 24, 20, 48), rows);
    op.queries = slice(qkv, 0, 16);
    op.keys = slice(qkv, 16, 16);
    op.values = slice(qkv, 32, 16);
    op.output = band(view(1, type(), 24, 20, 16), rows);
    op.shift = shift;
    op.rows = rows;
    expectMatch(op);
    op.queries = band(view(2, type(), 24, 20, 16), {4, 20});  // another tensor
    expectMatch(op);
  }
}

TEST_P(Band, ImagePipeline) {
  const TensorView aux = band(view(0, type(), 48, 20, 8), {14, 34});
  const TensorView mean = band(view(1, DataType::f32, 12, 5, 8), {2, 9}),
                   x = band(view(2, DataType::f32, 12, 5, 4), {2, 9});
  const TensorView network = band(view(3, type(), 48, 20, 40), {16, 32});
  const TensorView exposure = view(4, DataType::f32, 1, 1, 4);
  const TensorView output = band(view(5, DataType::f32, 48, 20, 4), {16, 32});
  const test::Contents contents{{4, {0.5f, 2, 1, 0}}};
  expectMatch(
      BoxMean{.input = aux, .output = band(view(6, DataType::f32, 12, 5, 8), {4, 8}), .scale = 4, .rows = {4, 8}});
  expectMatch(BoxMean{.input = aux, .output = band(view(6, type(), 48, 20, 8), {16, 40}), .rows = {16, 32}});
  expectMatch(JointBilateral{.input = x,
                             .aux = aux,
                             .auxMean = mean,
                             .network = network,
                             .output = output,
                             .normalOffset = 3,
                             .scale = 4,
                             .rows = {16, 28}});
  expectMatch(Bicubic{.input = x, .output = output, .scale = 4, .rows = {16, 30}});
  expectMatch(RadianceCeiling{.input = x,
                              .output = band(view(6, DataType::f32, 12, 5, 4), {4, 7}),
                              .transfer = Transfer::log1p,
                              .rows = {4, 7}});
  expectMatch(FilterAuxiliary{.aux = aux,
                              .network = network,
                              .output = band(view(6, type(), 48, 20, 8), {16, 32}),
                              .kernelSide = 3,
                              .firstLogit = 28,
                              .rows = {16, 32}});
  expectMatch(DecodeRadiance{.network = network,
                             .base = output,
                             .ceiling = band(view(8, DataType::f32, 12, 5, 4), {4, 8}),
                             .aux = aux,
                             .exposure = exposure,
                             .output = view(6, DataType::f32, 47, 20, 4),
                             .albedoOffset = 0,
                             .scale = 4,
                             .rows = {17, 31}},
              contents);
  expectMatch(EncodeRadiance{.colour = band(view(7, DataType::f32, 11, 5, 4), {0, 11}),
                             .exposure = exposure,
                             .auxMean = mean,
                             .output = band(view(6, DataType::f32, 12, 5, 4), {3, 12}),
                             .albedoOffset = 3,
                             .rows = {4, 8}},
              {{4, {0.5f, 2, 1, 0}}, {1, std::vector<float>(size_t{7} * 5 * 8, 0.5f)}});
  expectMatch(PackAuxiliary{.input = view(7, DataType::f32, 45, 20, 8),
                            .output = band(view(6, type(), 48, 20, 8), {40, 48}),
                            .rows = {41, 48}});
}

INSTANTIATE_TEST_SUITE_P(All, Band,
                         testing::Combine(testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane,
                                                          KernelFamily::tile)));

TEST(Tensor, RowsAreWhereTheyAreStored) {
  const TensorView whole{.value = 0, .height = 10, .width = 3, .channels = 4, .channelStride = 8};
  const TensorView rows = rowsOf(whole, {4, 7});
  EXPECT_EQ(rows.height, 3u);
  EXPECT_EQ(rows.storedByteSize(), whole.storedByteSize());
  EXPECT_EQ(rows.storedRow(0), 4u);
  EXPECT_EQ(rows.firstTexel(), 4u * 3 * 2);
  const TensorView part{.value = 1, .height = 3, .width = 3, .channels = 4, .channelStride = 8};
  const TensorView placed = asRowsOf(part, 10, 4);
  EXPECT_EQ(placed.height, 10u);
  EXPECT_EQ(placed.storedByteSize(), part.storedByteSize());
  EXPECT_EQ(placed.storedRow(4), 0u);
  EXPECT_EQ(placed.storedRow(7), 3u);  // the end of row 6
  EXPECT_THROW(placed.storedRow(3), std::logic_error);
  EXPECT_THROW(placed.storedRow(8), std::logic_error);
  EXPECT_EQ(placed.firstTexel() + 4u * 3 * 2, 0u);
}

TEST(HostMemory, RefusesRowsThatAreNotStored) {
  const TensorView part = band(view(0, DataType::f32, 10, 3, 4), {4, 7});
  HostMemory memory;
  memory.at(part, 4, 0, 0) = 1;
  memory.at(part, 6, 2, 3) = 2;
  EXPECT_EQ(memory.storage(part).size(), 36u);
  EXPECT_EQ(memory.storage(part).front(), 1);
  EXPECT_EQ(memory.storage(part).back(), 2);
  EXPECT_THROW(memory.at(part, 3, 2, 3), std::logic_error);
  EXPECT_THROW(memory.at(part, 7, 0, 0), std::logic_error);
}

}  // namespace
}  // namespace xrds
