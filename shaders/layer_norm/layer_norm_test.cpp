#include "shaders/layer_norm/layer_norm.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::layer_norm_test {
namespace {

using test::PrintTo;
using test::view;

struct Shape {
  uint32_t height, width, channels;
  uint32_t inputOffset = 0, inputStride = 0, outputOffset = 0, outputStride = 0;
  RowRange rows{};
};

// Odd ones first: one token, an uneven number of tokens, slices, rows that start inside an aligned block; at last
// tokens too wide for a tile.
constexpr Shape kShapes[] = {{1, 1, 4},
                             {3, 5, 12},
                             {7, 13, 20, 4, 28, 8, 36},
                             {9, 3, 8, 0, 8, 4, 12, {2, 7}},
                             {5, 1, 4, 0, 0, 0, 0, {1, 2}},
                             {16, 16, 64},
                             {11, 17, 128, 128, 256},
                             {3, 9, 388},
                             {2, 3, 516},
                             {2, 3, 1028}};

class LayerNormShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType, KernelFamily>> {};

TEST_P(LayerNormShapes, MatchesReference) {
  const auto& [s, inputType, outputType, family] = GetParam();
  DeviceTraits traits = test::gpu().traits();
  traits.family = family;
  const auto weight = test::randomNumbers(s.channels, 1), bias = test::randomNumbers(s.channels, 2);
  const LayerNorm op{.input = view(0, inputType, s.height, s.width, s.channels, s.inputOffset, s.inputStride),
                     .output = view(1, outputType, s.height, s.width, s.channels, s.outputOffset, s.outputStride),
                     .weight = weight,
                     .bias = bias,
                     .rows = s.rows};
  test::expectMatchesReference(op, traits, test::toleranceOf(outputType));
}

INSTANTIATE_TEST_SUITE_P(All, LayerNormShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(DataType::f32, DataType::f16),
                                          testing::Values(KernelFamily::plain, KernelFamily::tile)));

TEST(LayerNorm, FoldsMoreWorkgroupsThanADimensionHolds) {
  const std::vector<float> weight(64, 1), bias(64, 0);
  const LayerNorm op{.input = view(0, DataType::f32, 2048, 2048, 64),
                     .output = view(1, DataType::f32, 2048, 2048, 64),
                     .weight = weight,
                     .bias = bias};
  for (const KernelFamily family : {KernelFamily::plain, KernelFamily::tile}) {
    const auto [x, y, z] = dispatch(op, {.family = family}).groupCount;
    EXPECT_LE(x, 65535u);
    EXPECT_GT(y, 1u);
    EXPECT_EQ(z, 1u);
  }
}

TEST(LayerNorm, OfAFoldedGridMatchesReference) {
  const auto weight = test::randomNumbers(64, 1), bias = test::randomNumbers(64, 2);
  const LayerNorm op{.input = view(0, DataType::f32, 41, 13, 64),
                     .output = view(1, DataType::f32, 41, 13, 64),
                     .weight = weight,
                     .bias = bias};
  for (const KernelFamily family : {KernelFamily::plain, KernelFamily::tile}) {
    DeviceTraits traits = test::gpu().traits();
    traits.family = family;
    test::KernelCase kernel{.dispatch = dispatch(op, traits),
                            .weights = packedWeights(op, traits),
                            .output = op.output,
                            .reference = [&op](HostMemory& memory) { reference(op, memory); }};
    auto& groups = kernel.dispatch.groupCount;
    groups = {ceilDivide(groups[0], 4), 4, 1};  // as of a larger image, with some workgroups too many
    test::expectMatchesReference(kernel, test::toleranceOf(DataType::f32), {});
  }
}

TEST(LayerNorm, OfTwoLevelsIsPlusMinusOne) {
  const std::vector<float> weight(4, 1), bias(4, 0);
  HostMemory memory;
  const LayerNorm op{.input = view(0, DataType::f32, 1, 1, 4),
                     .output = view(1, DataType::f32, 1, 1, 4),
                     .weight = weight,
                     .bias = bias,
                     .epsilon = 0};
  memory.storage(op.input) = {5, 7, 7, 5};
  reference(op, memory);
  EXPECT_EQ(memory.storage(op.output), (std::vector<double>{-1, 1, 1, -1}));
}

TEST(LayerNorm, TakesTheKernelThatFitsTheWidth) {
  const auto programOf = [](uint32_t channels) {
    const std::vector<float> weight(channels), bias(channels);
    return dispatch(LayerNorm{.input = view(0, DataType::f32, 2, 2, channels),
                              .output = view(1, DataType::f32, 2, 2, channels),
                              .weight = weight,
                              .bias = bias},
                    {.family = KernelFamily::tile})
        .program;
  };
  EXPECT_EQ(programOf(4), "layer_norm_tile_f32");
  EXPECT_EQ(programOf(192), "layer_norm_tile_f32");
  EXPECT_EQ(programOf(1024), "layer_norm_tile_f32");
  EXPECT_EQ(programOf(1028), "layer_norm_plain_f32");
}

TEST(LayerNorm, RefusesWeightsOfAnotherWidth) {
  const std::vector<float> weight(8, 1), bias(4, 0);
  const LayerNorm op{.input = view(0, DataType::f32, 1, 1, 4),
                     .output = view(1, DataType::f32, 1, 1, 4),
                     .weight = weight,
                     .bias = bias};
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::layer_norm_test
