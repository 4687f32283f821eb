#include "network/joined_weights.h"

#include <gtest/gtest.h>

#include "shaders/conv3x3/conv3x3.h"
#include "shaders/fold/fold.h"
#include "tests/harness.h"

namespace xrds {
namespace {

using test::view;

// Thin images, too: every pixel at a border.
constexpr struct { uint32_t height, width; } kSizes[] = {{1, 1}, {1, 3}, {4, 1}, {2, 2}, {3, 5}};
constexpr uint32_t kBefore = 12, kChannels = 8;  // of a doubling

Conv3x3 convolution(TensorView input, TensorView output, ConvWeights weights, uint32_t inputs, bool shuffle) {
  Conv3x3 op{.input = input, .output = output, .weight = weights.weight, .bias = weights.bias};
  op.inputChannels = inputs;
  op.outputChannels = static_cast<uint32_t>(weights.bias.size());
  op.shuffleOutput = shuffle;
  return op;
}

// The doubling of random pixels, as values 0 and 1.
class JoinedWeightsOfDoubling : public testing::Test {
 protected:
  void make(uint32_t height, uint32_t width) {
    memory = {};
    x = view(0, DataType::f32, height, width, kBefore);
    doubled = view(1, DataType::f32, 2 * height, 2 * width, kChannels);
    const auto pixels = test::randomNumbers(x.storedElementCount(), 7);
    std::copy(pixels.begin(), pixels.end(), memory.storage(x).begin());
    reference(convolution(x, doubled, doubling, kBefore, true), memory);
  }
  void expectEqual(const TensorView& expected, const TensorView& found, uint32_t channels) {
    for (uint32_t y = 0; y < expected.height; ++y)
      for (uint32_t i = 0; i < expected.width; ++i)
        for (uint32_t c = 0; c < channels; ++c)
          EXPECT_NEAR(memory.at(found, y, i, c), memory.at(expected, y, i, c), 1e-5) << y << " " << i << " " << c;
  }

  const std::vector<float> weight = test::randomNumbers(4 * kChannels * kBefore * 9, 1),
                           bias = test::randomNumbers(4 * kChannels, 2);
  const ConvWeights doubling{weight, bias};
  HostMemory memory;
  TensorView x, doubled;
};

TEST_F(JoinedWeightsOfDoubling, AreTheOutputOfIt) {
  constexpr uint32_t kOutputs = 3, kInputs = kChannels + 4;  // of which the last belong to something else
  const auto weights = test::randomNumbers(kOutputs * kInputs, 3), biases = test::randomNumbers(kOutputs, 4);
  const JoinedWeights joined = joinedWithOutput(doubling, {weights, biases});
  for (const auto& [height, width] : kSizes) {
    make(height, width);
    const TensorView expected = view(2, DataType::f32, 2 * height, 2 * width, 4),
                     found = view(3, DataType::f32, 2 * height, 2 * width, 4);
    for (uint32_t y = 0; y < expected.height; ++y)
      for (uint32_t i = 0; i < expected.width; ++i)
        for (uint32_t n = 0; n < kOutputs; ++n) {
          double sum = biases[n];
          for (uint32_t k = 0; k < kChannels; ++k) sum += weights[n * kInputs + k] * memory.at(doubled, y, i, k);
          memory.at(expected, y, i, n) = sum;
        }
    reference(convolution(x, found, {joined.weight, joined.bias}, kBefore, true), memory);
    expectEqual(expected, found, 4);
  }
}

TEST_F(JoinedWeightsOfDoubling, ArePatchesOfTheOutputWithZeroPadding) {
  constexpr uint32_t kOutputs = 3;
  const auto weights = test::randomNumbers(kOutputs * kChannels * 9, 3), biases = test::randomNumbers(kOutputs, 4);
  const JoinedWeights joined = joinedAsPatches(doubling, {weights, biases});
  for (const auto& [height, width] : kSizes) {
    make(height, width);
    const TensorView expected = view(2, DataType::f32, 2 * height, 2 * width, 4),
                     found = view(3, DataType::f32, 2 * height, 2 * width, 4);
    const TensorView patches = view(4, DataType::f32, height, width, 16 * kOutputs);
    reference(convolution(doubled, expected, {weights, biases}, kChannels, false), memory);
    reference(convolution(x, patches, {joined.weight, joined.bias}, kBefore, false), memory);
    reference(Fold{patches, found}, memory);
    expectEqual(expected, found, kOutputs);
  }
}

}  // namespace
}  // namespace xrds
