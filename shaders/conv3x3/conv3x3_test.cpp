#include "shaders/conv3x3/conv3x3.h"

#include <gtest/gtest.h>

#include <set>

#include "engine/kernel_family.h"
#include "shaders/conv3x3/lanes.h"
#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::conv3x3_test {
namespace {

using test::PrintTo;
using test::view;

enum class Layout { straight, unshuffled, shuffled };

struct Case {
  uint32_t height, width;  // of the convolution
  uint32_t inputs, outputs;
  Layout layout = Layout::straight;
  Activation activation = Activation::none;
  bool residual = false, inPlace = false;
  uint32_t inputOffset = 0, inputStride = 0, outputOffset = 0, outputStride = 0;
  RowRange rows{};
  bool inFours = false;
  uint32_t seenColumns = 0;
};

constexpr Case inFours(Case c) {
  c.inFours = true;
  return c;
}

constexpr Case seeing(uint32_t columns, Case c) {
  c.seenColumns = columns;
  return c;
}

// Odd ones first: one pixel, channels of padding, slices, rows that start inside an aligned block, then the layouts and
// widths of the network.
constexpr Case kCases[] = {
    {1, 1, 4, 4},
    {3, 5, 3, 4, Layout::straight, Activation::relu},
    {5, 3, 6, 16, Layout::straight, Activation::leakyRelu},
    {6, 19, 16, 3, Layout::straight, Activation::none, true},
    {9, 7, 12, 20, Layout::straight, Activation::gelu, true, true, 4, 20, 8, 32},
    {11, 4, 8, 24, Layout::straight, Activation::none, true, false, 0, 0, 4, 32, {5, 10}},
    {7, 33, 24, 28, Layout::straight, Activation::none, false, false, 8, 64},
    {2, 3, 16, 8, Layout::unshuffled, Activation::relu},
    {7, 17, 32, 16, Layout::unshuffled, Activation::none, true, false, 8, 24, 0, 0, {1, 6}},
    {3, 5, 8, 16, Layout::shuffled, Activation::relu, true},
    {6, 17, 16, 32, Layout::shuffled, Activation::none, true, true, 0, 0, 8, 24, {2, 5}},
    {5, 6, 8, 64, Layout::shuffled},
    {18, 37, 32, 32, Layout::straight, Activation::none, true},
    {9, 20, 64, 64, Layout::straight, Activation::leakyRelu},
    // Even widths, which the lane kernel takes: one pair, groups that end within a subgroup and behind it, rows of a
    // band.
    {3, 2, 8, 8},
    {5, 70, 16, 16, Layout::straight, Activation::relu, true},
    {10, 64, 12, 28, Layout::straight, Activation::none, false, false, 4, 24, 4, 36, {3, 8}},
    {6, 36, 16, 48, Layout::unshuffled, Activation::gelu},
    {2, 1180, 4, 8, Layout::straight, Activation::none, true, true},
    {7, 34, 16, 64, Layout::shuffled, Activation::none, true, false, 0, 0, 4, 24, {1, 7}},
    {7, 34, 16, 16, Layout::shuffled, Activation::none, true, false, 0, 0, 4, 12, {1, 7}},
    // Of which the last columns are not seen.
    seeing(1, {2, 2, 4, 4}),
    seeing(5, {3, 6, 8, 8, Layout::straight, Activation::relu, true}),
    seeing(7, {5, 9, 12, 20}),
    seeing(18, {4, 20, 16, 32, Layout::unshuffled}),
    seeing(35, inFours({6, 36, 32, 32, Layout::straight, Activation::relu})),
    // By fours: one of them, groups that end within a subgroup and behind it, none left over, the layouts.
    inFours({3, 4, 8, 8}),
    inFours({5, 140, 16, 16, Layout::straight, Activation::relu, true}),
    inFours({10, 64, 12, 28, Layout::straight, Activation::none, false, false, 4, 24, 4, 36, {3, 8}}),
    inFours({2, 1180, 4, 8, Layout::straight, Activation::none, true, true}),
    inFours({6, 36, 16, 48, Layout::unshuffled, Activation::gelu}),
    inFours({7, 36, 16, 64, Layout::shuffled, Activation::none, true, false, 0, 0, 4, 24, {1, 7}}),
    inFours({7, 36, 16, 16, Layout::shuffled, Activation::none, true, false, 0, 0, 4, 12, {1, 7}}),
};

std::vector<float> halves(std::vector<float> numbers) {
  for (float& number : numbers) number = static_cast<float>(static_cast<int>(number * 512)) / 512;
  return numbers;
}

constexpr uint32_t roundUp4(uint32_t channels) { return (channels + 3) / 4 * 4; }

Conv3x3 operatorOf(const Case& c, DataType stored, std::span<const float> weight, std::span<const float> bias) {
  const bool unshuffled = c.layout == Layout::unshuffled, shuffled = c.layout == Layout::shuffled;
  const uint32_t in = unshuffled ? 2 : 1, out = shuffled ? 2 : 1;
  Conv3x3 op{
      .input = view(0, stored, c.height * in, c.width * in, roundUp4(c.inputs / in / in), c.inputOffset, c.inputStride),
      .output = view(1, stored, c.height * out, c.width * out, roundUp4(c.outputs / out / out), c.outputOffset,
                     c.outputStride),
      .weight = weight,
      .bias = bias,
      .inputChannels = c.inputs,
      .outputChannels = c.outputs,
      .activation = c.activation,
      .unshuffleInput = unshuffled,
      .shuffleOutput = shuffled,
      .inFours = c.inFours,
      .rows = c.rows,
      .seenColumns = c.seenColumns};
  if (c.residual) op.residual = op.output;
  if (c.residual && !c.inPlace) op.residual = view(2, stored, op.output.height, op.output.width, op.output.channels);
  return op;
}

class Conv3x3Cases : public testing::TestWithParam<std::tuple<Case, KernelFamily, DataType>> {};

TEST_P(Conv3x3Cases, MatchesReference) {
  const auto& [c, family, stored] = GetParam();  // weights are stored as the tensors are, but for kernels by fours
  const auto weight = halves(test::randomNumbers(size_t{c.outputs} * c.inputs * 9, 1));
  const auto bias = halves(test::randomNumbers(c.outputs, 2));
  Conv3x3 op = operatorOf(c, stored, weight, bias);
  op.weightType = c.inFours && family == KernelFamily::lane ? DataType::f32 : stored;
  const DeviceTraits traits = test::traitsOf(family);
  test::expectMatchesReference(op, traits, test::toleranceOf(stored));
  if (family == KernelFamily::lane && stored == DataType::f32)
    test::expectMatchesReferenceByAddress(op, c.outputs <= 4 || (c.inFours && c.inputs <= 4));
}

INSTANTIATE_TEST_SUITE_P(All, Conv3x3Cases,
                         testing::Combine(testing::ValuesIn(kCases),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane, KernelFamily::tile),
                                          testing::Values(DataType::f32, DataType::f16)));
INSTANTIATE_TEST_SUITE_P(Matrix, Conv3x3Cases,
                         testing::Combine(testing::ValuesIn(kCases), testing::Values(KernelFamily::matrix),
                                          testing::Values(DataType::f16)));

class Conv3x3OnGpus : public testing::TestWithParam<uint32_t> {};

TEST_P(Conv3x3OnGpus, MatchesReferenceInTheShapesThatTuningTries) {
  DeviceTraits traits = test::traitsOf(KernelFamily::tile);
  traits.registers = GetParam();
  for (const Case& c : {Case{9, 37, 20, 24}, {10, 7, 20, 64, Layout::shuffled}, {5, 18, 64, 16, Layout::unshuffled}}) {
    const auto weight = halves(test::randomNumbers(size_t{c.outputs} * c.inputs * 9, 1));
    const auto bias = halves(test::randomNumbers(c.outputs, 2));
    const Conv3x3 op = operatorOf(c, DataType::f32, weight, bias);
    std::set<std::vector<uint32_t>> kernels;
    for (const KernelShape& shape : shapesToTry(op, traits)) {
      traits.shape = shape;
      SCOPED_TRACE(std::to_string(shape.outputs) + " pixels, rows " + std::to_string(shape.rows));
      EXPECT_EQ(dispatch(op, traits).program, "conv3x3_tile_f32");
      kernels.insert(dispatch(op, traits).specialization);
      test::expectMatchesReference(op, traits, test::toleranceOf(DataType::f32));
    }
    EXPECT_EQ(kernels.size(), 3u);
  }
}

INSTANTIATE_TEST_SUITE_P(Registers, Conv3x3OnGpus, testing::Values(128u, 256u));

// Small integers, of which every order of the sums gives the same float.
TEST(Conv3x3, IsExactOnMatrixUnits) {
  for (const Case& c : {Case{9, 17, 16, 16},
                        {3, 33, 36, 40},
                        {5, 18, 64, 64, Layout::unshuffled},
                        {10, 7, 20, 144, Layout::shuffled}}) {
    const auto weight = test::smallIntegers(size_t{c.outputs} * c.inputs * 9, 1);
    const auto bias = test::smallIntegers(c.outputs, 2);
    Conv3x3 op = operatorOf(c, DataType::f16, weight, bias);
    op.output.type = DataType::f32;
    op.weightType = DataType::f16;
    const DeviceTraits traits = test::traitsOf(KernelFamily::matrix);
    EXPECT_NE(dispatch(op, traits).program.find("_matrix_"), std::string::npos);
    test::expectMatchesReference(op, traits, {}, {{0, test::smallIntegers(op.input.storedElementCount(), 3)}});
  }
}

// As a growing concatenation does: the output is a slice of the tensor that the input is a slice of.
TEST(Conv3x3, WritesBesideWhatItReads) {
  for (const KernelFamily family : {KernelFamily::plain, KernelFamily::lane, KernelFamily::tile})
    for (const DataType stored : {DataType::f32, DataType::f16}) {
      const auto weight = halves(test::randomNumbers(8 * 16 * 9, 1)), bias = halves(test::randomNumbers(8, 2));
      Conv3x3 op = operatorOf({9, 21, 16, 8, Layout::straight, Activation::relu}, stored, weight, bias);
      op.input = view(0, stored, 9, 21, 16, 0, 32);
      op.output = view(0, stored, 9, 21, 8, 16, 32);
      op.weightType = stored;
      const DeviceTraits traits = test::traitsOf(family);
      test::expectMatchesReference(op, traits, test::toleranceOf(stored));
    }
}

TEST(Conv3x3, ComputesByFoursWhereItMayWithFullWeights) {
  const std::vector<float> weight(8 * 8 * 9), bias(8);
  const auto programOf = [&](uint32_t width, bool inFours, DataType weights) {
    Conv3x3 op = operatorOf({4, width, 8, 8}, DataType::f32, weight, bias);
    op.inFours = inFours;
    op.weightType = weights;
    DeviceTraits traits = test::traitsOf(KernelFamily::lane);
    traits.shape = {.outputs = 8, .rows = 2};  // no turns
    traits.bufferAddresses = false;
    return dispatch(op, traits).program;
  };
  for (const uint32_t width : {4u, 36u, 1024u}) EXPECT_EQ(programOf(width, true, DataType::f32), "conv3x3_lane4_f32");
  EXPECT_EQ(programOf(38, true, DataType::f32), "conv3x3_lane_f32");
  EXPECT_EQ(programOf(36, false, DataType::f32), "conv3x3_lane_f32");
  EXPECT_EQ(programOf(36, true, DataType::f16), "conv3x3_lane_f32");
}

struct Conv3x3InTurns : testing::Test {
  Dispatch launchOf(Case c, DeviceTraits device) const {
    device.family = KernelFamily::lane;
    device.shaderInt64 = true;
    const auto weight = std::span(numbers).first(size_t{c.outputs} * c.inputs * 9);
    return dispatch(operatorOf(c, DataType::f32, weight, std::span(numbers).first(c.outputs)), device);
  }
  bool takesTurns(const Case& c, const DeviceTraits& device = {.subgroupSize = 8}) const {
    return launchOf(c, device).program.find("_turns_") != std::string::npos;
  }

  const std::vector<float> numbers = std::vector<float>(size_t{64} * 64 * 9, 1);
};

TEST_F(Conv3x3InTurns, WhereTheWeightsFitInSharedMemory) {
  EXPECT_EQ(launchOf(inFours({4, 64, 16, 16}), {.subgroupSize = 8}).program, "conv3x3_lane4_turns_f32");
  EXPECT_FALSE(takesTurns(inFours({4, 64, 16, 16}), {.subgroupSize = 16})) << "compiles longer than it gains";
  EXPECT_TRUE(takesTurns({4, 64, 16, 16}, {.shape = {.outputs = 16, .rows = kConv3x3InTurns}, .subgroupSize = 16}));
  EXPECT_TRUE(takesTurns({4, 64, 32, 32}));
  EXPECT_FALSE(takesTurns(inFours({4, 64, 32, 32}))) << "36 KiB";
  for (const Case& c : {Case{4, 64, 4, 16}, {4, 64, 16, 4}, {4, 64, 16, 16, Layout::unshuffled}})
    EXPECT_FALSE(takesTurns(c)) << testing::PrintToString(c);
  EXPECT_FALSE(takesTurns({4, 64, 16, 16}, {.shape = {.outputs = 16, .rows = 2}, .subgroupSize = 8}));
  for (const LaneCode code : {LaneCode::broadcasts, LaneCode::scalars})
    EXPECT_TRUE(takesTurns({4, 64, 16, 16}, {.subgroupSize = 8, .laneCode = code, .bufferAddresses = true}));
}

// On any device, by request: side by side, below each other, in several workgroups, one row of a lane.
TEST_F(Conv3x3InTurns, MatchReference) {
  DeviceTraits traits = test::traitsOf(KernelFamily::lane);
  for (const Case& c :
       {inFours({4, 1024, 8, 8, Layout::straight, Activation::relu}),
        inFours({32, 36, 16, 16, Layout::straight, Activation::none, true, true}),
        inFours({7, 132, 8, 32, Layout::shuffled, Activation::leakyRelu, true, false, 0, 0, 8, 32}),
        Case{12, 70, 32, 16, Layout::straight, Activation::gelu, true, true, 4, 40}, seeing(33, {6, 36, 12, 8})})
    for (const DataType stored : {DataType::f32, DataType::f16}) {
      const auto weight = halves(test::randomNumbers(size_t{c.outputs} * c.inputs * 9, 1));
      const auto bias = halves(test::randomNumbers(c.outputs, 2));
      Conv3x3 op = operatorOf(c, stored, weight, bias);
      op.weightType = c.inFours ? DataType::f32 : stored;
      traits.shape = {.outputs = std::min(c.outputs, 16u), .rows = kConv3x3InTurns};
      EXPECT_NE(dispatch(op, traits).program.find("_turns_"), std::string::npos) << testing::PrintToString(c);
      test::expectMatchesReference(op, traits, test::toleranceOf(stored));
    }
}

TEST_F(Conv3x3InTurns, ShareASecondLevelCacheInFewProgramsForFramesOfAllSizes) {
  const auto subgroups = [&](uint32_t width, uint64_t bytes) {
    return launchOf(inFours({18, width, 16, 16}), {.subgroupSize = 8, .secondCacheBytes = bytes}).specialization[5];
  };
  EXPECT_EQ(subgroups(1024, uint64_t{64} << 10), 4u);
  EXPECT_EQ(subgroups(1024 + 128, uint64_t{1} << 20), 4u) << "36 subgroups in a row";
  EXPECT_EQ(subgroups(1024 + 32, uint64_t{1} << 20), 1u) << "33 subgroups in a row, and nine rows of two";
  std::set<uint32_t> counts;
  for (uint32_t width = 4; width < 2000; width += 4) counts.insert(subgroups(width, uint64_t{1} << 20));
  EXPECT_EQ(counts, (std::set<uint32_t>{1, 2, 4, 8, 16}));
}

TEST(Conv3x3, TakesTheTilesThatFitTheDevice) {
  const auto launchOn = [](DeviceTraits device, const Case& c) {
    const std::vector<float> weight(size_t{c.outputs} * c.inputs * 9), bias(c.outputs);
    return dispatch(operatorOf(c, DataType::f32, weight, bias), device);
  };
  const DeviceTraits gpu{.family = KernelFamily::tile, .maxGroupInvocations = 256};
  EXPECT_EQ(launchOn(gpu, {40, 40, 64, 64}).program, "conv3x3_tile_f32");
  EXPECT_EQ(launchOn(gpu, {40, 40, 64, 64}).groupCount, (std::array<uint32_t, 3>{1, 3, 5}));
  EXPECT_EQ(launchOn(gpu, {40, 40, 64, 256, Layout::shuffled}).groupCount, (std::array<uint32_t, 3>{4, 3, 5}));
  EXPECT_EQ(launchOn(gpu, {640, 512, 4, 3}).groupCount, (std::array<uint32_t, 3>{1, 16, 20}));
  EXPECT_EQ(launchOn(gpu, {40, 40, 32, 3}).groupCount,
            (std::array<uint32_t, 3>{1, 2, 5}));  // smaller, but more of them
  DeviceTraits small = gpu;
  small.maxSharedBytes = 16384;
  EXPECT_EQ(launchOn(small, {640, 512, 4, 3}).groupCount, (std::array<uint32_t, 3>{1, 16, 40}));
  small.maxSharedBytes = 8192;
  EXPECT_EQ(launchOn(small, {40, 40, 64, 64}).program, "conv3x3_plain_f32");
}

TEST(Conv3x3, TakesLessAtOnceWhereRegistersAreFew) {
  const std::vector<float> weight(64 * 64 * 9), bias(64);
  const auto constantOn = [&](const DeviceTraits& device, size_t constant) {
    Conv3x3 op = operatorOf({40, 40, 64, 64}, DataType::f16, weight, bias);
    op.weightType = DataType::f16;
    return dispatch(op, device).specialization.at(constant);
  };
  constexpr size_t kPixels = 5, kFragments = 1;
  DeviceTraits device = usualTraits(KernelFamily::tile);
  EXPECT_EQ(constantOn(device, kPixels), 8u);
  device.registers = 128;
  EXPECT_EQ(constantOn(device, kPixels), 4u);
  device.shape.outputs = 8;
  EXPECT_EQ(constantOn(device, kPixels), 8u);

  device = usualTraits(KernelFamily::matrix);
  EXPECT_EQ(constantOn(device, kFragments), 4u);
  device.registers = 128;
  EXPECT_EQ(constantOn(device, kFragments), 4u) << "16 KiB of a subgroup of 32";
  device.leastSubgroup = 16;
  EXPECT_EQ(constantOn(device, kFragments), 2u) << "of any subgroup where the smallest have 8 KiB";
}

// A kernel whose only weight is at the tap: the output is the input moved by one pixel, zero moving in.
TEST(Conv3x3, OfOneTapMovesTheImage) {
  std::vector<float> weight(4 * 4 * 9), bias(4);
  for (uint32_t c = 0; c < 4; ++c) weight[(c * 4 + c) * 9 + 1 * 3 + 2] = 1;  // ky 1, kx 2: the right neighbour
  HostMemory memory;
  const Conv3x3 op{.input = view(0, DataType::f32, 1, 3, 4),
                   .output = view(1, DataType::f32, 1, 3, 4),
                   .weight = weight,
                   .bias = bias,
                   .inputChannels = 4,
                   .outputChannels = 4};
  memory.storage(op.input) = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  reference(op, memory);
  EXPECT_EQ(memory.storage(op.output), (std::vector<double>{5, 6, 7, 8, 9, 10, 11, 12, 0, 0, 0, 0}));
}

// Centre taps that copy channels: unshuffle and shuffle are each other's inverse, channel c of part (y, x) being
// 4 c + 2 y + x.
TEST(Conv3x3, ShufflesAsPixelShuffleDoes) {
  std::vector<float> weight(16 * 16 * 9), bias(16);
  for (uint32_t c = 0; c < 16; ++c) weight[(c * 16 + c) * 9 + 4] = 1;
  HostMemory memory;
  Conv3x3 op{.input = view(0, DataType::f32, 2, 2, 4),
             .output = view(1, DataType::f32, 1, 1, 16),
             .weight = weight,
             .bias = bias,
             .inputChannels = 16,
             .outputChannels = 16,
             .unshuffleInput = true};
  auto& pixels = memory.storage(op.input);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<double>(i);
  const auto original = pixels;
  reference(op, memory);
  EXPECT_EQ(memory.at(op.output, 0, 0, 4 * 3 + 2 * 1 + 0), memory.at(op.input, 1, 0, 3));
  const Conv3x3 back{.input = op.output,
                     .output = view(2, DataType::f32, 2, 2, 4),
                     .weight = weight,
                     .bias = bias,
                     .inputChannels = 16,
                     .outputChannels = 16,
                     .shuffleOutput = true};
  reference(back, memory);
  EXPECT_EQ(memory.storage(back.output), original);
}

TEST(Conv3x3, CountsTheMultiplyAddsOfItsWeight) {
  const std::vector<float> weight(3 * 6 * 9), bias(3);
  const Conv3x3 op{.input = view(0, DataType::f32, 5, 7, 8),
                   .output = view(1, DataType::f32, 5, 7, 4),
                   .weight = weight,
                   .bias = bias,
                   .inputChannels = 6,
                   .outputChannels = 3,
                   .rows = {1, 4}};
  EXPECT_EQ(dispatch(op, {}).multiplyAdds, 3u * 7 * 9 * 6 * 3);
}

TEST(Conv3x3, SavesProductsByWinograd) {
  const std::vector<float> weight(8 * 8 * 9), bias(8);
  Conv3x3 op = operatorOf({4, 16, 8, 8}, DataType::f32, weight, bias);
  const uint64_t all = 4u * 16 * 9 * 8 * 8;
  EXPECT_EQ(dispatch(op, test::traitsOf(KernelFamily::plain)).savedProducts, 0u);
  EXPECT_EQ(dispatch(op, test::traitsOf(KernelFamily::lane)).savedProducts, all / 3);
  op.inFours = true;
  EXPECT_EQ(dispatch(op, test::traitsOf(KernelFamily::lane)).savedProducts, all / 2);
}

TEST(Conv3x3, RefusesWhatDoesNotFit) {
  const std::vector<float> weight(8 * 4 * 9), bias(8);
  const Conv3x3 op{.input = view(0, DataType::f32, 3, 4, 4),
                   .output = view(1, DataType::f32, 3, 4, 8),
                   .weight = weight,
                   .bias = bias,
                   .inputChannels = 4,
                   .outputChannels = 8};
  EXPECT_NO_THROW(dispatch(op, {}));
  Conv3x3 wrong = op;
  wrong.output.channels = 4;
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong = op;
  wrong.residual = view(2, DataType::f32, 3, 4, 4);
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong = op;
  wrong.inputChannels = 8;
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong = op;
  wrong.unshuffleInput = true;  // three rows
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
  wrong = op;
  wrong.shuffleOutput = true;  // eight channels give two
  EXPECT_THROW(dispatch(wrong, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::conv3x3_test
