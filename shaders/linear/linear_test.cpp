#include "shaders/linear/linear.h"

#include <gtest/gtest.h>

#include <set>

#include "shaders/common/matrix.h"
#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::linear_test {
namespace {

using test::PrintTo;
using test::view;

struct Case {
  uint32_t height, width, inputs, outputs;
  Activation activation = Activation::none;
  bool residual = false, inPlace = false;
  uint32_t inputOffset = 0, inputStride = 0, outputOffset = 0, outputStride = 0;
  RowRange rows{};
  bool norm = false;
  uint32_t appended = 0;  // of the inputs
};

// Odd ones first: one token, channels that are no multiple of a tile, slices that start at a 4 or an 8, rows that start
// inside an aligned block, then the widths of the network, then one that is too wide for the lane kernel, and enough
// work for the largest tiles; outputs that are no multiple of four; SwinIR's, which are no multiple of eight; a large
// frame whose last workgroup of the lane kernel has subgroups without tokens.
constexpr Case kCases[] = {{1, 1, 4, 4},
                           {3, 5, 12, 20, Activation::relu},
                           {7, 3, 20, 28, Activation::leakyRelu, true},
                           {5, 9, 8, 24, Activation::gelu, true, true, 4, 16, 4, 32},
                           {6, 5, 16, 48, Activation::none, true, false, 0, 20, 8, 64, {2, 5}},
                           {33, 17, 16, 8, Activation::gelu, false, false, 8, 32, 0, 0, {31, 33}},
                           {9, 67, 64, 192},
                           {5, 11, 192, 64, Activation::none, true, true, 64, 256, 128, 192},
                           {4, 9, 384, 40, Activation::gelu},
                           {2, 3, 1600, 8, Activation::none, true},
                           {33, 63, 20, 1024, Activation::relu},
                           {7, 33, 24, 3},
                           {9, 40, 48, 53, Activation::none, false, false, 0, 0, 0, 0, {4, 9}},
                           {3, 5, 12, 20, Activation::gelu, true, false, 4, 20, 0, 0, {1, 3}, true},
                           {7, 33, 32, 96, Activation::none, false, false, 0, 64, 0, 0, {}, true},
                           {2, 3, 1600, 8, Activation::none, false, false, 0, 0, 0, 0, {}, true},
                           {3, 5, 12, 20, Activation::relu, true, false, 4, 16, 0, 0, {1, 3}, true, 8},
                           {9, 40, 48, 53, Activation::none, false, false, 0, 0, 0, 0, {4, 9}, false, 16},
                           {7, 33, 68, 64, Activation::none, true, true, 0, 0, 0, 0, {}, false, 36},
                           {9, 40, 24, 3, Activation::relu, false, false, 0, 0, 0, 0, {4, 9}, false, 8},
                           {3, 33, 180, 180, Activation::none, true, true},
                           {2, 35, 360, 180, Activation::none, true, false, 0, 0, 180, 368},
                           {5, 9, 60, 60, Activation::gelu, false, false, 4, 68, 0, 0, {}, true},
                           {67, 63, 8, 12, Activation::relu, false, false, 0, 0, 4, 24}};

std::vector<float> halves(std::vector<float> numbers) {
  for (float& number : numbers) number = static_cast<float>(static_cast<int>(number * 512)) / 512;
  return numbers;
}

class LinearCases : public testing::TestWithParam<std::tuple<Case, KernelFamily, DataType>> {};

TEST_P(LinearCases, MatchesReference) {
  const auto& [c, family, stored] = GetParam();  // weights are stored as the tensors are
  const auto weight = halves(test::randomNumbers(size_t{c.outputs} * c.inputs, 1));
  const auto bias = halves(test::randomNumbers(c.outputs, 2));
  Linear op{.input = view(0, stored, c.height, c.width, c.inputs - c.appended, c.inputOffset, c.inputStride),
            .output = view(1, stored, c.height, c.width, ceilDivide(c.outputs, 4) * 4, c.outputOffset, c.outputStride),
            .weight = weight,
            .bias = bias,
            .activation = c.activation,
            .weightType = stored,
            .rows = c.rows};
  const auto gain = halves(test::randomNumbers(c.inputs, 3)), shift = halves(test::randomNumbers(c.inputs, 4));
  if (c.norm) op.norm = {gain, shift};
  if (c.appended) op.appended = view(3, stored, c.height, c.width, c.appended, 4, c.appended + 8);
  if (c.residual) op.residual = c.inPlace ? op.output : view(2, stored, c.height, c.width, c.outputs);
  test::expectMatchesReference(op, test::traitsOf(family), test::toleranceOf(stored));
  if (family == KernelFamily::lane && stored == DataType::f32)
    test::expectMatchesReferenceByAddress(op, c.inputs <= 16);
}

INSTANTIATE_TEST_SUITE_P(All, LinearCases,
                         testing::Combine(testing::ValuesIn(kCases),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane, KernelFamily::tile),
                                          testing::Values(DataType::f32, DataType::f16)));
INSTANTIATE_TEST_SUITE_P(Matrix, LinearCases,
                         testing::Combine(testing::ValuesIn(kCases), testing::Values(KernelFamily::matrix),
                                          testing::Values(DataType::f16)));

// Small integers, of which every order of the sums gives the same float.
TEST(Linear, IsExactOnMatrixUnits) {
  for (const Case& c : {Case{7, 19, 16, 16}, {5, 31, 40, 36}, {3, 47, 100, 132}, {2, 65, 64, 64}}) {
    const auto weight = test::smallIntegers(size_t{c.outputs} * c.inputs, 1), bias = test::smallIntegers(c.outputs, 2);
    const Linear op{.input = view(0, DataType::f16, c.height, c.width, c.inputs, 4, c.inputs + 4),
                    .output = view(1, DataType::f32, c.height, c.width, c.outputs),
                    .weight = weight,
                    .bias = bias,
                    .weightType = DataType::f16};
    const DeviceTraits traits = test::traitsOf(KernelFamily::matrix);
    EXPECT_NE(dispatch(op, traits).program.find("_matrix_"), std::string::npos);
    test::expectMatchesReference(op, traits, {}, {{0, test::smallIntegers(op.input.storedElementCount(), 3)}});
  }
}

TEST(Linear, HasFewProgramsForFramesOfAllSizes) {
  const std::vector<float> weight(64), bias(8);
  DeviceTraits traits = test::traitsOf(KernelFamily::lane);
  traits.laneCode = LaneCode::shuffles;  // not the form that reads weights by address
  for (const bool hasResidual : {false, true}) {
    std::set<std::vector<uint32_t>> programs;
    for (uint32_t width = 1; width < 400; ++width) {
      Linear op{.input = view(0, DataType::f32, 16, width, 8),
                .output = view(1, DataType::f32, 16, width, 8),
                .weight = weight,
                .bias = bias};
      if (hasResidual) op.residual = op.output;
      const Dispatch launch = dispatch(op, traits);
      ASSERT_EQ(launch.program, "linear_lane_f32");
      programs.insert(launch.specialization);
    }
    EXPECT_EQ(programs.size(), hasResidual ? 3u : 2u);
  }
}

TEST(Linear, TakesMatrixUnitsForHalvesAlone) {
  const std::vector<float> weight(64 * 64), bias(64);
  const auto programOf = [&](DataType input, DataType weights, uint32_t outputs) {
    return dispatch(Linear{.input = view(0, input, 4, 4, 64),
                           .output = view(1, DataType::f16, 4, 4, outputs),
                           .weight = std::span(weight).first(size_t{64} * outputs),
                           .bias = std::span(bias).first(outputs),
                           .weightType = weights},
                    {.family = KernelFamily::matrix, .matrixUnits = MatrixUnits::nv, .subgroupSize = 32})
        .program;
  };
  EXPECT_EQ(programOf(DataType::f16, DataType::f16, 64), "linear_matrix_nv_f16");
  EXPECT_EQ(programOf(DataType::f32, DataType::f16, 64), "linear_tile_f16");
  EXPECT_EQ(programOf(DataType::f16, DataType::f32, 64), "linear_tile_f16");
  EXPECT_EQ(programOf(DataType::f16, DataType::f16, 12), "linear_tile_f16");
}

TEST(MatrixShape, SharesTheFragmentsAmongTheSubgroups) {
  const auto expectShape = [](uint32_t subgroupSize, uint32_t outputs, const MatrixShape& expected) {
    const MatrixShape found =
        matrixShape({.family = KernelFamily::matrix, .matrixUnits = MatrixUnits::nv, .subgroupSize = subgroupSize}, {},
                    DataType::f16, DataType::f16, 64, outputs);
    EXPECT_EQ(found.subgroups, expected.subgroups);
    EXPECT_EQ(found.outputs, expected.outputs);
    EXPECT_EQ(found.rows, expected.rows);
    EXPECT_EQ(found.columns, expected.columns);
    EXPECT_EQ(found.subgroups * found.rows * found.columns, shader::kMatrixRows * found.outputs);
  };
  expectShape(32, 192, {8, 4, 2, 2});
  expectShape(32, 32, {8, 2, 2, 1});
  expectShape(32, 16, {8, 1, 1, 1});
  expectShape(64, 64, {4, 4, 2, 4});
  expectShape(16, 64, {16, 4, 2, 1});
  expectShape(16, 16, {8, 1, 1, 1});
  expectShape(8, 64, {16, 4, 2, 1});
}

TEST(Linear, ConvertsBetweenStorageTypes) {
  const auto weight = test::randomNumbers(16 * 16, 1), bias = test::randomNumbers(16, 2);
  for (const KernelFamily family : {KernelFamily::plain, KernelFamily::lane, KernelFamily::tile}) {
    const DeviceTraits traits = test::traitsOf(family);
    test::expectMatchesReference(Linear{.input = view(0, DataType::f16, 5, 7, 16),
                                        .output = view(1, DataType::f32, 5, 7, 16),
                                        .residual = view(2, DataType::f16, 5, 7, 16),
                                        .weight = weight,
                                        .bias = bias},
                                 traits, test::toleranceOf(DataType::f32));
  }
}

TEST(Linear, TakesTheTilesThatFitTheDevice) {
  const std::vector<float> weight(64 * 64), bias(64);
  const auto launchOn = [&](DeviceTraits device, uint32_t height) {
    return dispatch(Linear{.input = view(0, DataType::f32, height, 256, 64),
                           .output = view(1, DataType::f32, height, 256, 64),
                           .weight = weight,
                           .bias = bias},
                    device);
  };
  const DeviceTraits gpu{.family = KernelFamily::tile, .maxSharedBytes = 16384, .maxGroupInvocations = 256};
  EXPECT_EQ(launchOn(gpu, 256).program, "linear_tile_f32");
  EXPECT_EQ(launchOn(gpu, 256).groupCount, (std::array<uint32_t, 3>{1, 256 * 256 / 128, 1}));
  EXPECT_EQ(launchOn(gpu, 16).groupCount, (std::array<uint32_t, 3>{1, 16 * 256 / 32, 1}));  // smaller, but more of them
  DeviceTraits small = gpu;
  small.registers = 64;
  EXPECT_EQ(launchOn(small, 256).groupCount, (std::array<uint32_t, 3>{1, 256 * 256 / 64, 1}));
  small = gpu;
  small.maxSharedBytes = 8192;
  EXPECT_EQ(launchOn(small, 256).groupCount, (std::array<uint32_t, 3>{1, 256 * 256 / 64, 1}));
  small.maxSharedBytes = 4096;
  EXPECT_EQ(launchOn(small, 256).program, "linear_plain_f32");
  small = gpu;
  small.maxGroupInvocations = 128;
  EXPECT_EQ(launchOn(small, 256).program, "linear_plain_f32");
}

TEST(Linear, MatchesReferenceInTheShapesThatTuningTries) {
  const auto weight = halves(test::randomNumbers(size_t{96} * 64, 1)), bias = halves(test::randomNumbers(96, 2));
  for (const DataType stored : {DataType::f32, DataType::f16}) {
    Linear op{
        .input = view(0, stored, 7, 33, 64), .output = view(1, stored, 7, 33, 96), .weight = weight, .bias = bias};
    op.residual = op.output;
    op.weightType = stored;
    DeviceTraits traits = test::traitsOf(KernelFamily::lane);
    for (const KernelShape& shape : shapesToTry(op, traits)) {
      traits.shape = shape;
      SCOPED_TRACE(std::to_string(shape.outputs) + " outputs, order " + std::to_string(shape.rows));
      test::expectMatchesReference(op, traits, test::toleranceOf(stored));
    }
  }
}

TEST(Linear, ReadsWeightsByAddressWhereTheCompilerKnowsScalars) {
  const std::vector<float> numbers(96 * 96, 1);
  const auto launchOn = [&](DeviceTraits device, DataType stored, DataType weights) {
    device.family = KernelFamily::lane;
    device.shaderInt64 = true;
    return dispatch(Linear{.input = view(0, stored, 32, 32, 96),
                           .output = view(1, stored, 32, 32, 96),
                           .weight = numbers,
                           .bias = std::span(numbers).first(96),
                           .weightType = weights},
                    device);
  };
  const auto f32 = DataType::f32, f16 = DataType::f16;
  const DeviceTraits scalars{.laneCode = LaneCode::scalars, .bufferAddresses = true};
  const Dispatch launch = launchOn(scalars, f32, f32);
  EXPECT_EQ(launch.program, "linear_lane_f32_addressed");
  EXPECT_TRUE(launch.weightsByAddress);
  EXPECT_EQ(launch.groupCount[0], 1u) << "all outputs are one tile";
  EXPECT_EQ(launchOn(scalars, f16, f32).program, "linear_lane_f16");
  EXPECT_EQ(launchOn(scalars, f32, f16).program, "linear_lane_f32");
  EXPECT_EQ(launchOn({.laneCode = LaneCode::scalars}, f32, f32).program, "linear_lane_f32");
  EXPECT_EQ(launchOn({.laneCode = LaneCode::broadcasts, .bufferAddresses = true}, f32, f32).program, "linear_lane_f32");
}

TEST(Linear, TakesTurnsOnVectorsOf256BitsWhereTheCodeIsLong) {
  const std::vector<float> numbers(size_t{192} * 96, 1);
  const auto takesTurns = [&](uint32_t inputs, DeviceTraits device) {
    const Linear op{.input = view(0, DataType::f32, 32, 32, inputs),
                    .output = view(1, DataType::f32, 32, 32, 96),
                    .weight = std::span(numbers).first(size_t{inputs} * 96),
                    .bias = std::span(numbers).first(96)};
    device.family = KernelFamily::lane;
    device.shaderInt64 = true;
    return dispatch(op, device).specialization[9] == 1;
  };
  EXPECT_TRUE(takesTurns(64, {.subgroupSize = 8}));
  EXPECT_TRUE(takesTurns(32, {.subgroupSize = 8}));
  EXPECT_TRUE(takesTurns(16, {.subgroupSize = 8}));
  EXPECT_FALSE(takesTurns(8, {.subgroupSize = 8}));
  EXPECT_FALSE(takesTurns(96, {.subgroupSize = 8})) << "the tokens leave a second-level cache of 512 KiB";
  EXPECT_TRUE(takesTurns(128, {.subgroupSize = 8, .secondCacheBytes = uint64_t{1} << 20}));
  EXPECT_FALSE(takesTurns(192, {.subgroupSize = 8, .secondCacheBytes = uint64_t{1} << 20}));
  EXPECT_FALSE(takesTurns(64, {.subgroupSize = 16}));
  EXPECT_TRUE(takesTurns(64, {.subgroupSize = 8, .laneCode = LaneCode::broadcasts, .bufferAddresses = true}));
  EXPECT_TRUE(takesTurns(64, {.subgroupSize = 8, .laneCode = LaneCode::scalars}));
  EXPECT_FALSE(takesTurns(64, {.subgroupSize = 8, .laneCode = LaneCode::scalars, .bufferAddresses = true}))
      << "weights by address are read in a loop";
  EXPECT_TRUE(takesTurns(32, {.shape = {.outputs = 48, .rows = 2}, .subgroupSize = 16}));
  EXPECT_FALSE(takesTurns(64, {.shape = {.outputs = 48, .rows = 1}, .subgroupSize = 8}));
  EXPECT_FALSE(takesTurns(64, {.shape = {.outputs = 8, .rows = 2}, .subgroupSize = 8})) << "eight outputs are one turn";
}

TEST(Linear, JoinsTheFirstMapWithItsOwn) {
  const std::vector<float> weight = test::randomNumbers(20 * 12, 1), bias = test::randomNumbers(20, 2),
                           first = test::randomNumbers(12 * 48, 3), firstBias = test::randomNumbers(12, 4);
  for (const KernelFamily family : {KernelFamily::plain, KernelFamily::lane, KernelFamily::tile}) {
    const Linear op{.input = view(0, DataType::f32, 5, 7, 48, 16, 64),
                    .output = view(1, DataType::f32, 5, 7, 20),
                    .residual = view(2, DataType::f32, 5, 7, 20),
                    .weight = weight,
                    .bias = bias,
                    .first = {first, firstBias},
                    .activation = Activation::relu};
    EXPECT_EQ(dispatch(op, test::traitsOf(family)).multiplyAdds, 5u * 7 * 48 * 20);
    test::expectMatchesReference(op, test::traitsOf(family), test::toleranceOf(DataType::f32));
  }
  Linear wrong{.input = view(0, DataType::f32, 5, 7, 48),
               .output = view(1, DataType::f32, 5, 7, 20),
               .weight = weight,
               .bias = bias,
               .first = {std::span(first).subspan(1), firstBias}};
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong.first = {first, std::span(firstBias).subspan(1)};
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
}

// Of tokens whose mean is a thousand times their deviation.
TEST(Linear, NormalizesWithoutCancellation) {
  const std::vector<float> weight = test::randomNumbers(16 * 32, 1), bias(16), gain(32, 1), shift(32, 0);
  for (const KernelFamily family : {KernelFamily::plain, KernelFamily::lane}) {
    const Linear op{.input = view(0, DataType::f32, 3, 7, 32),
                    .output = view(1, DataType::f32, 3, 7, 16),
                    .weight = weight,
                    .bias = bias,
                    .norm = {gain, shift}};
    auto tokens = test::randomNumbers(op.input.storedElementCount(), 2);
    for (float& x : tokens) x = 1000 + std::round(x * 64) / 64;
    test::expectMatchesReference(op, test::traitsOf(family), test::toleranceOf(DataType::f32), {{0, tokens}});
  }
}

TEST(Linear, OfThePermutationSwapsChannels) {
  const std::vector<float> weight{0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0}, bias{0, 0, 0, -10};
  HostMemory memory;
  const Linear op{.input = view(0, DataType::f32, 1, 1, 4),
                  .output = view(1, DataType::f32, 1, 1, 4),
                  .residual = view(1, DataType::f32, 1, 1, 4),
                  .weight = weight,
                  .bias = bias,
                  .activation = Activation::relu};
  memory.storage(op.input) = {1, 2, 3, 4};
  memory.storage(op.output) = {100, 200, 300, 400};
  reference(op, memory);
  EXPECT_EQ(memory.storage(op.output), (std::vector<double>{104, 203, 302, 400}));
}

TEST(Linear, CountsTheMultiplyAddsOfItsRows) {
  const std::vector<float> weight(8 * 4), bias(8);
  const Linear op{.input = view(0, DataType::f32, 5, 3, 4),
                  .output = view(1, DataType::f32, 5, 3, 8),
                  .weight = weight,
                  .bias = bias,
                  .rows = {1, 3}};
  EXPECT_EQ(dispatch(op, {}).multiplyAdds, 2u * 3 * 4 * 8);
}

TEST(Linear, RefusesViewsOfAnotherShape) {
  const std::vector<float> weight(8 * 4), bias(8);
  const Linear op{.input = view(0, DataType::f32, 2, 2, 4),
                  .output = view(1, DataType::f32, 2, 2, 8),
                  .weight = weight,
                  .bias = bias};
  Linear wrongOutput = op, wrongResidual = op, wrongWeight = op, tooMuch = op, wrongAppended = op;
  tooMuch.appended = view(3, DataType::f32, 2, 2, 4);
  wrongAppended.input = view(0, DataType::f32, 2, 2, 4, 0, 8);
  const std::vector<float> wider(8 * 8);
  wrongAppended.weight = wider;
  wrongAppended.appended = view(3, DataType::f32, 2, 3, 4);
  wrongOutput.output.channels = 4;
  wrongResidual.residual = view(2, DataType::f32, 2, 3, 8);
  wrongWeight.weight = wrongWeight.weight.subspan(1);
  EXPECT_NO_THROW(dispatch(op, {}));
  EXPECT_THROW(dispatch(wrongOutput, {}), std::logic_error);
  EXPECT_THROW(dispatch(wrongResidual, {}), std::logic_error);
  EXPECT_THROW(dispatch(wrongWeight, {}), std::logic_error);
  EXPECT_THROW(dispatch(tooMuch, {}), std::logic_error);
  EXPECT_THROW(dispatch(wrongAppended, {}), std::logic_error);
  wrongAppended.appended.width = 2;
  EXPECT_NO_THROW(dispatch(wrongAppended, {}));
}

}  // namespace
}  // namespace xrds::linear_test
