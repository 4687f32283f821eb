#include "graph/convolution.h"

#include <gtest/gtest.h>

#include <random>

#include "graph/bands.h"
#include "graph/in_place.h"

namespace xrds {
namespace {

std::vector<float> numbers(size_t count, uint32_t seed) {
  std::mt19937 bits(seed);
  std::vector<float> made(count);
  for (float& number : made) number = static_cast<float>(bits() >> 8) * 0x1p-23F - 1;
  return made;
}

/// A convolution of its own image, and its weights.
struct Convolution {
  Graph graph;
  std::vector<float> weight, bias;
  Conv3x3 op;

  Convolution(uint32_t height, uint32_t width, uint32_t inputs, uint32_t outputs)
      : weight(numbers(size_t{9} * inputs * outputs, 1)), bias(numbers(outputs, 2)) {
    op.input = graph.create("x", DataType::f32, {height, width, alignUp(inputs, 4)});
    op.output = graph.create("y", DataType::f32, {height, width, alignUp(outputs, 4)});
    op.weight = weight;
    op.bias = bias;
    op.inputChannels = inputs;
    op.outputChannels = outputs;
    op.inFours = true;
  }
};

void fill(HostMemory& memory, const TensorView& view, uint32_t seed) {
  auto& values = memory.storage(view);
  const std::vector<float> made = numbers(values.size(), seed);
  std::copy(made.begin(), made.end(), values.begin());
}

// The steps give what the convolution does, in double precision.
void expectTheConvolution(Convolution& c, bool atOnce, size_t nodes) {
  HostMemory expected, found;
  for (HostMemory* memory : {&expected, &found}) {
    fill(*memory, c.op.input, 3);
    fill(*memory, c.op.output, 4);
    if (c.op.residual.exists() && c.op.residual.value != c.op.output.value) fill(*memory, c.op.residual, 5);
  }
  reference(c.op, expected);
  addInSquares(c.graph, "conv", c.op, atOnce);
  EXPECT_EQ(c.graph.nodes.size(), nodes);
  for (const Node& node : c.graph.nodes) std::visit([&](const auto& op) { reference(op, found); }, node.op);
  const auto &want = expected.storage(c.op.output), &have = found.storage(c.op.output);
  for (size_t i = 0; i < want.size(); ++i) ASSERT_NEAR(have[i], want[i], 1e-5) << i;
}

TEST(ConvolutionInSquares, IsTheConvolutionAtOddSizes) {
  Convolution c(11, 20, 6, 7);
  c.op.activation = Activation::leakyRelu;
  expectTheConvolution(c, false, 3);
}

TEST(ConvolutionInSquares, ComputesRowsOfABand) {
  Convolution c(18, 12, 8, 8);
  c.op.rows = {4, 12};
  c.op.residual = c.op.output;
  expectTheConvolution(c, false, 3);
}

TEST(ConvolutionInSquares, SeesSomeColumnsAlone) {
  Convolution c(5, 12, 4, 4);
  c.op.seenColumns = 9;
  expectTheConvolution(c, true, 3);
}

TEST(ConvolutionInSquares, ShufflesItsOutput) {
  Convolution c(6, 8, 8, 32);
  c.op.output = c.graph.create("shuffled", DataType::f32, {12, 16, 8});
  c.op.shuffleOutput = true;
  c.op.residual = c.graph.create("residual", DataType::f32, {12, 16, 8});
  c.op.activation = Activation::relu;
  expectTheConvolution(c, true, 3);
}

TEST(ConvolutionInSquares, MakesManyOutputsInTurns) {
  Convolution c(4, 4, 4, 512);
  c.op.residual = c.graph.create("residual", DataType::f32, {4, 4, 512});
  expectTheConvolution(c, true, 5);
  Convolution shuffled(4, 4, 4, 1024);
  shuffled.op.output = shuffled.graph.create("shuffled", DataType::f32, {8, 8, 256});
  shuffled.op.shuffleOutput = true;
  expectTheConvolution(shuffled, true, 9);
}

// [upsampled, x] convolved and pooled, as the operators themselves make it.
TEST(ConvolutionInSquares, ReadsAndStoresHalfTheResolution) {
  for (const RowRange rows : {RowRange{}, RowRange{4, 12}})
    for (const bool isUpsampled : {true, false})
      for (const bool isPooled : {true, false}) {
        Convolution c(18, 12, 14, 8);
        c.op.activation = Activation::relu;
        c.op.seenColumns = 10;
        c.op.rows = rows;
        const TensorView half = c.graph.create("half", DataType::f32, {9, 6, 8});
        const TensorView pooled = c.graph.create("pooled", DataType::f32, {9, 6, 8});
        HostMemory expected, found;
        for (HostMemory* memory : {&expected, &found}) {
          fill(*memory, c.op.input, 3);
          fill(*memory, half, 4);
          fill(*memory, pooled, 5);
          fill(*memory, c.op.output, 6);
        }
        if (isUpsampled) reference(UpsampleNearest{half, slice(c.op.input, 0, 8)}, expected);
        reference(c.op, expected);
        if (isPooled) reference(MaxPool{c.op.output, pooled, {rows.begin / 2, rows.end / 2}}, expected);

        Conv3x3 own = c.op;
        if (isUpsampled) own.input = slice(own.input, 8, 8);
        addInSquares(c.graph, "conv", own, false,
                     {isUpsampled ? half : TensorView{}, isPooled ? pooled : TensorView{}});
        for (const Node& node : c.graph.nodes) std::visit([&](const auto& op) { reference(op, found); }, node.op);
        const TensorView& stored = isPooled ? pooled : c.op.output;
        const auto &want = expected.storage(stored), &have = found.storage(stored);
        for (size_t i = 0; i < want.size(); ++i) ASSERT_NEAR(have[i], want[i], 1e-5) << i;
      }
}

TEST(ConvolutionInSquares, IsMadeInBandsThatCachesHold) {
  Convolution c(256, 256, 64, 64);
  addInSquares(c.graph, "conv", c.op, false);
  EXPECT_EQ(c.graph.nodes.size(), 3U * 8);
  for (size_t i = 2; i < c.graph.values.size(); ++i) EXPECT_LE(c.graph.values[i].byteSize(), 8U << 20);
  for (size_t i = 0; i < c.graph.nodes.size(); i += 3)
    EXPECT_EQ(outputRows(c.graph.nodes[i]).begin * 4, outputRows(c.graph.nodes[i + 2]).begin);
}

// A residual that nothing reads afterwards is where the sum is made, band by band.
TEST(ConvolutionInSquares, AddsToItsResidualInPlace) {
  Convolution c(256, 256, 64, 64);
  c.op.residual = c.graph.create("residual", DataType::f32, c.op.output.shape());
  copyRows(c.graph, "residual", c.op.input, c.op.residual);
  c.graph.colour = c.op.input;
  c.graph.exposure = c.graph.create("exposure", DataType::f32, {1, 1, 4});
  c.graph.output = c.op.output;
  addInSquares(c.graph, "conv", c.op, false);
  EXPECT_EQ(inPlaceStorage(c.graph)[c.op.output.value], c.op.residual.value);
  c.graph.nodes.pop_back();
  WinogradOutput last = std::get<WinogradOutput>(c.graph.nodes[3].op);
  last.residual = slice(last.residual, 0, 64);
  last.residual.firstRow = 1;  // of other rows than its own
  last.residual.storedHeight = 256;
  c.graph.nodes[3].op = last;
  EXPECT_NE(inPlaceStorage(c.graph)[c.op.output.value], c.op.residual.value);
}

TEST(ConvolutionInSquares, IsWorthItForWideOnes) {
  EXPECT_TRUE(isWorthSquares(Convolution(8, 8, 64, 64).op));
  EXPECT_TRUE(isWorthSquares(Convolution(8, 8, 32, 128).op));
  EXPECT_FALSE(isWorthSquares(Convolution(8, 8, 16, 16).op));
  EXPECT_FALSE(isWorthSquares(Convolution(8, 8, 64, 4).op));
  EXPECT_FALSE(isWorthSquares(Convolution(8, 10, 64, 64).op));
  Convolution c(8, 8, 64, 64);
  c.op.weightType = DataType::f16;
  EXPECT_FALSE(isWorthSquares(c.op));
  c.op.weightType = DataType::f32;
  c.op.inFours = false;
  EXPECT_FALSE(isWorthSquares(c.op));
}

}  // namespace
}  // namespace xrds
