#include "shaders/window_attention/window_attention.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/recording.h"
#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::window_attention_test {
namespace {

using test::PrintTo;
using test::traitsOf;
using test::view;

enum class Layout { oneTensor, keysWithValues, separate };

struct Shape {
  uint32_t height, width, window, headChannels, heads, shift = 0;
  Layout layout = Layout::oneTensor;
  RowRange rows{};
};

// Odd ones first: one window, windows and heads that do not fill subgroups, slices, rows inside a window, wrapped rows.
constexpr Shape kShapes[] = {{2, 2, 2, 4, 1},
                             {2, 4, 2, 4, 3, 1, Layout::separate},
                             {3, 9, 3, 4, 2},
                             {6, 18, 6, 12, 1, 3, Layout::keysWithValues},
                             {4, 12, 4, 8, 2, 2},
                             {12, 4, 4, 16, 3, 2, Layout::separate},
                             {8, 8, 8, 32, 1, 4},
                             {8, 24, 8, 8, 2, 0, Layout::keysWithValues},
                             {24, 16, 8, 32, 2, 4},
                             {24, 16, 8, 32, 2, 4, Layout::separate, {3, 6}},
                             {24, 16, 8, 16, 1, 4, Layout::oneTensor, {0, 4}},
                             {24, 16, 8, 16, 1, 4, Layout::oneTensor, {4, 20}},
                             {24, 16, 8, 4, 1, 4, Layout::oneTensor, {1, 23}},
                             {24, 16, 8, 4, 1, 0, Layout::oneTensor, {7, 9}},
                             {16, 16, 8, 64, 1, 4},
                             {16, 32, 16, 32, 1, 8},
                             {16, 16, 8, 132, 1}};

// An operator with the numbers that it refers to.
struct Attention {
  std::vector<float> biasTable;
  WindowAttention op;
};

Attention attentionOf(const Shape& s, DataType inputType = DataType::f32, DataType outputType = DataType::f32) {
  const uint32_t c = s.headChannels * s.heads, relative = 2 * s.window - 1;
  Attention attention{.biasTable = test::randomNumbers(size_t{relative} * relative * s.heads, 7)};
  const auto slices = [&](ValueId value, uint32_t count) {
    return view(value, inputType, s.height, s.width, count * c, 4, count * c + 8);
  };
  WindowAttention& op = attention.op;
  switch (s.layout) {
    case Layout::oneTensor:
      op.queries = slice(slices(0, 3), 0, c), op.keys = slice(slices(0, 3), c, c);
      op.values = slice(slices(0, 3), 2 * c, c);
      break;
    case Layout::keysWithValues:
      op.queries = slices(0, 1), op.keys = slice(slices(1, 2), 0, c), op.values = slice(slices(1, 2), c, c);
      break;
    case Layout::separate:
      op.queries = slices(0, 1), op.keys = slices(1, 1), op.values = slices(2, 1);
  }
  const uint32_t offset = s.layout == Layout::separate ? 4 : 8;  // only multiples of 8 allow the widest stores
  op.output = view(3, outputType, s.height, s.width, c, offset, c + 16);
  op.biasTable = attention.biasTable;
  op.window = s.window, op.headChannels = s.headChannels, op.shift = s.shift, op.rows = s.rows;
  return attention;
}

bool canRun(KernelFamily family) {
  return family != KernelFamily::lane || test::gpu().description().kind == DeviceKind::cpu;
}

class WindowAttentionShapes : public testing::TestWithParam<std::tuple<Shape, DataType, DataType, KernelFamily>> {};

TEST_P(WindowAttentionShapes, MatchesReference) {
  const auto& [shape, inputType, outputType, family] = GetParam();
  if (!canRun(family)) GTEST_SKIP() << "the lane kernel is for CPU devices";
  const Attention attention = attentionOf(shape, inputType, outputType);
  test::expectMatchesReference(attention.op, traitsOf(family), test::toleranceOf(outputType));
}

constexpr Shape kHalfShapes[] = {{4, 4, 2, 4, 2, 1, Layout::separate},
                                 {24, 16, 8, 16, 1, 4, Layout::oneTensor, {3, 20}}};
const auto kFamilies = testing::Values(KernelFamily::plain, KernelFamily::lane, KernelFamily::tile);
constexpr Shape kMatrixShapes[] = {{8, 8, 8, 16, 1},
                                   {8, 8, 8, 32, 1, 4},
                                   {24, 16, 8, 32, 2, 4, Layout::keysWithValues},
                                   {24, 16, 8, 32, 2, 4, Layout::separate, {3, 6}},
                                   {24, 16, 8, 16, 3, 0, Layout::oneTensor, {7, 9}},
                                   {16, 24, 8, 48, 1, 4},
                                   {16, 16, 8, 64, 2, 0}};
const auto kTypes = testing::Values(DataType::f32, DataType::f16);

INSTANTIATE_TEST_SUITE_P(All, WindowAttentionShapes,
                         testing::Combine(testing::ValuesIn(kShapes), testing::Values(DataType::f32),
                                          testing::Values(DataType::f32), kFamilies));
INSTANTIATE_TEST_SUITE_P(Types, WindowAttentionShapes,
                         testing::Combine(testing::ValuesIn(kHalfShapes), kTypes, kTypes, kFamilies));

INSTANTIATE_TEST_SUITE_P(Matrix, WindowAttentionShapes,
                         testing::Combine(testing::ValuesIn(kMatrixShapes), testing::Values(DataType::f16),
                                          testing::Values(DataType::f16), testing::Values(KernelFamily::matrix)));

TEST(WindowAttention, TheMatrixKernelTakesHalvesInWindowsOfEightAlone) {
  const auto programOf = [](uint32_t window, uint32_t headChannels, DataType input, DataType output = DataType::f16) {
    const Attention attention = attentionOf({16, 16, window, headChannels, 2}, input, output);
    return dispatch(attention.op, traitsOf(KernelFamily::matrix)).program;
  };
  EXPECT_TRUE(programOf(8, 32, DataType::f16).starts_with("window_attention_matrix_"));
  EXPECT_TRUE(programOf(8, 16, DataType::f16).starts_with("window_attention_matrix_"));
  EXPECT_EQ(programOf(8, 32, DataType::f32), "window_attention_tile_f16");
  EXPECT_EQ(programOf(8, 32, DataType::f16, DataType::f32), "window_attention_tile_f32");
  EXPECT_EQ(programOf(8, 24, DataType::f16), "window_attention_tile_f16");
  EXPECT_EQ(programOf(4, 32, DataType::f16), "window_attention_tile_f16");
}

class WindowAttentionFamilies : public testing::TestWithParam<KernelFamily> {
  void SetUp() override {
    if (!canRun(GetParam())) GTEST_SKIP() << "the lane kernel is for CPU devices";
  }
};

INSTANTIATE_TEST_SUITE_P(All, WindowAttentionFamilies, kFamilies);

TEST_P(WindowAttentionFamilies, KeepsScoresWhoseExponentialOverflows) {
  Attention attention = attentionOf({16, 16, 8, 8, 1, 4});
  for (float& bias : attention.biasTable) bias += 100;
  test::expectMatchesReference(attention.op, traitsOf(GetParam()), test::toleranceOf(DataType::f32));
}

TEST(WindowAttention, TheMatrixKernelKeepsScoresWhoseExponentialOverflows) {
  Attention attention = attentionOf({16, 16, 8, 16, 2, 4}, DataType::f16, DataType::f16);
  for (float& bias : attention.biasTable) bias += 100;
  test::expectMatchesReference(attention.op, traitsOf(KernelFamily::matrix), test::toleranceOf(DataType::f16));
}

TEST_P(WindowAttentionFamilies, KeepsValuesThatAreConstantWhereTokensSeeEachOther) {
  const Attention attention = attentionOf({16, 24, 8, 8, 1, 4, Layout::separate});
  const WindowAttention& op = attention.op;
  HostMemory expected;
  for (uint32_t y = 0; y < op.output.height; ++y)
    for (uint32_t x = 0; x < op.output.width; ++x)
      for (uint32_t c = 0; c < op.output.channels; ++c) {
        const bool bottom = y >= 12, right = x >= 20;  // rows 12-15 and 0-3 share the last row of windows
        expected.at(op.values, y, x, c) = 1 + (y < 4) + 2 * bottom + 4 * (x < 4) + 8 * right;
      }
  const std::vector<float> values(expected.storage(op.values).begin(), expected.storage(op.values).end());
  test::expectMatchesReference(op, traitsOf(GetParam()), test::toleranceOf(DataType::f32), {{op.values.value, values}});
  reference(op, expected);
  for (const auto& [y, x] : {std::pair{0, 0}, {3, 23}, {15, 3}, {12, 20}, {5, 5}, {13, 7}})
    EXPECT_NEAR(expected.at(op.output, y, x, 0), expected.at(op.values, y, x, 0), 1e-12) << y << " " << x;
}

// The stored bytes of the output when the dispatches follow each other.
std::vector<std::byte> outputOf(std::span<const WindowAttention> ops, const DeviceTraits& traits) {
  Gpu& gpu = test::gpu();
  const auto numbers = test::randomNumbers(ops[0].queries.storedByteSize() / 4, 3);
  const auto weights = packedWeights(ops[0], traits);
  Buffer inputs(gpu, numbers.size() * 4), packed(gpu, weights.size() * 4), output(gpu, ops[0].output.storedByteSize());
  inputs.upload(0, std::as_bytes(std::span(numbers)));
  packed.upload(0, std::as_bytes(std::span(weights)));
  output.fill(~0u);
  std::vector<PlacedDispatch> placed;
  for (const WindowAttention& op : ops) {
    placed.push_back({dispatch(op, traits), {}});
    for (const Binding& binding : placed.back().dispatch.bindings) {
      const Buffer& buffer = binding.value == kWeights ? packed : binding.access == Access::read ? inputs : output;
      const uint64_t size = binding.value == kWeights ? weights.size() * 4 : binding.byteSize;
      placed.back().ranges.push_back({&buffer, binding.byteOffset, size});
    }
  }
  Recording(gpu, placed).run();
  std::vector<std::byte> bytes(output.byteSize());
  output.download(0, bytes);
  return bytes;
}

TEST_P(WindowAttentionFamilies, BandsOfRowsUniteToTheWhole) {
  Attention attention = attentionOf({32, 8, 8, 16, 3, 4});
  attention.op.output.type = DataType::f32;
  const std::vector<std::byte> whole = outputOf({&attention.op, 1}, traitsOf(GetParam()));
  std::vector<WindowAttention> bands;
  for (const RowRange rows : {RowRange{0, 4}, {4, 20}, {20, 25}, {25, 32}}) {
    bands.push_back(attention.op);
    bands.back().rows = rows;
  }
  EXPECT_TRUE(outputOf(bands, traitsOf(GetParam())) == whole);
}

TEST(WindowAttention, StagesTheKeysThatFitTheDevice) {
  const auto launchOn = [](uint32_t maxSharedBytes, const Shape& shape) {
    return dispatch(attentionOf(shape).op, {.family = KernelFamily::tile, .maxSharedBytes = maxSharedBytes});
  };
  using Constants = std::vector<uint32_t>;
  EXPECT_EQ(launchOn(32768, {24, 16, 8, 32, 2, 4}).program, "window_attention_tile_f32");
  EXPECT_EQ(launchOn(32768, {24, 16, 8, 32, 2, 4}).groupCount, (std::array<uint32_t, 3>{2, 3, 2}));
  EXPECT_EQ(launchOn(32768, {24, 16, 8, 32, 2, 4}).specialization, (Constants{64, 8, 32, 16, 1}));
  EXPECT_EQ(launchOn(4096, {24, 16, 8, 32, 2, 4}).specialization, (Constants{64, 8, 32, 8, 1}));
  EXPECT_EQ(launchOn(32768, {16, 32, 16, 32, 1, 0}).specialization, (Constants{256, 16, 32, 16, 0}));
  EXPECT_EQ(launchOn(32768, {4, 4, 2, 4, 1}).specialization, (Constants{4, 2, 4, 8, 0}));
  EXPECT_EQ(launchOn(4096, {16, 32, 16, 32, 1, 8}).program, "window_attention_plain_f32");
  EXPECT_EQ(launchOn(32768, {16, 16, 8, 132, 1}).program, "window_attention_plain_f32");
}

TEST(WindowAttention, OfEqualScoresIsTheMean) {
  Attention attention = attentionOf({2, 2, 2, 4, 1, 0, Layout::separate});
  std::ranges::fill(attention.biasTable, 3.0f);
  HostMemory memory;
  double sum = 0;
  for (const auto& [y, x] : {std::pair{0u, 0u}, {0u, 1u}, {1u, 0u}, {1u, 1u}}) {
    memory.at(attention.op.queries, y, x, 0) = 5;
    memory.at(attention.op.keys, y, x, 0) = -2;
    sum += memory.at(attention.op.values, y, x, 2) = 10 * y + x;
  }
  reference(attention.op, memory);
  EXPECT_NEAR(memory.at(attention.op.output, 1, 0, 2), sum / 4, 1e-12);
}

TEST(WindowAttention, ComputesOnlyTheWindowsOfItsRows) {
  const DeviceTraits traits;
  const auto groupRows = [&](RowRange rows) {
    return dispatch(attentionOf({32, 8, 8, 16, 1, 4, Layout::oneTensor, rows}).op, traits).groupCount[1];
  };
  EXPECT_EQ(groupRows({}), 4u);
  EXPECT_EQ(groupRows({4, 20}), 2u);
  EXPECT_EQ(groupRows({0, 4}), 1u);
  EXPECT_EQ(groupRows({28, 32}), 1u);
  EXPECT_EQ(groupRows({3, 5}), 2u);
}

TEST(WindowAttention, RefusesSizesThatDoNotFit) {
  const auto refused = [](const Shape& shape, auto change) {
    Attention attention = attentionOf(shape);
    change(attention.op);
    EXPECT_THROW(dispatch(attention.op, {}), std::logic_error);
  };
  const auto asIs = [](WindowAttention&) {};
  refused({12, 8, 8, 8, 1}, asIs);
  refused({8, 12, 8, 8, 1}, asIs);
  refused({8, 8, 8, 8, 1, 3}, asIs);
  refused({1, 1, 1, 8, 1}, asIs);
  refused({34, 34, 34 / 2, 8, 1}, asIs);
  refused({8, 8, 8, 8, 2}, [](WindowAttention& op) { op.headChannels = 12; });
  refused({8, 8, 8, 8, 2}, [](WindowAttention& op) { op.biasTable = op.biasTable.first(225); });
  refused({8, 8, 8, 8, 1}, [](WindowAttention& op) { op.keys.width = 16; });
  refused({8, 8, 8, 8, 1}, [](WindowAttention& op) { op.output.channels = 4; });
}

}  // namespace
}  // namespace xrds::window_attention_test
