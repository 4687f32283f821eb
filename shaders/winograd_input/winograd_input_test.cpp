#include "shaders/winograd_input/winograd_input.h"

#include <gtest/gtest.h>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::winograd_input_test {
namespace {

using test::PrintTo;
using test::view;

struct Case {
  uint32_t height, width, channels;  // of the image
  RowRange rows{};                   // of squares
  uint32_t seenColumns = 0;
  bool upsampled = false;
};

// One square and less than one, rows that end inside of one, more squares than lanes, columns that are not seen,
// images of twice the resolution.
constexpr Case kCases[] = {{1, 4, 4},
                           {4, 4, 8},
                           {6, 8, 12},
                           {13, 20, 20},
                           {18, 76, 32},
                           {23, 36, 16, {2, 5}},
                           {9, 132, 4, {1, 3}},
                           {5, 8, 8, {}, 1},
                           {12, 36, 36, {}, 30},
                           {2, 4, 4, {}, 0, true},
                           {14, 20, 20, {}, 0, true},
                           {18, 76, 32, {1, 4}, 70, true}};

WinogradInput inputOf(const Case& c, DataType stored) {
  const uint32_t planes = 36 * c.channels, repeats = c.upsampled ? 2 : 1;
  return {.input = view(0, stored, c.height / repeats, c.width / repeats, c.channels, 4, c.channels + 8),
          .output = view(1, DataType::f32, ceilDivide(c.height, 4), c.width / 4, planes, 8, planes + 16),
          .rows = c.rows,
          .seenColumns = c.seenColumns,
          .upsampled = c.upsampled};
}

class WinogradInputCases : public testing::TestWithParam<std::tuple<Case, KernelFamily, DataType>> {};

TEST_P(WinogradInputCases, MatchesReference) {
  const auto& [c, family, stored] = GetParam();
  test::expectMatchesReference(inputOf(c, stored), test::traitsOf(family), toleranceOf(DataType::f32));
}

INSTANTIATE_TEST_SUITE_P(All, WinogradInputCases,
                         testing::Combine(testing::ValuesIn(kCases),
                                          testing::Values(KernelFamily::plain, KernelFamily::lane),
                                          testing::Values(DataType::f32, DataType::f16)));

// With products by what stands in place of the weights, its output gives the convolution.
TEST(WinogradInput, GivesTheConvolution) {
  const auto numbers = test::randomNumbers(36 + 9, 1);
  HostMemory memory;
  const WinogradInput op{.input = view(0, DataType::f32, 4, 4, 4), .output = view(1, DataType::f32, 1, 1, 144)};
  for (uint32_t i = 0; i < 16; ++i) memory.at(op.input, i / 4, i % 4, 2) = numbers[i];
  reference(op, memory);
  std::array<double, 9> weights;
  for (uint32_t i = 0; i < 9; ++i) weights[i] = numbers[36 + i];
  std::array<double, 36> products = winogradWeights(weights);
  for (uint32_t e = 0; e < 36; ++e) products[e] *= memory.at(op.output, 0, 0, 4 * e + 2);
  const std::array<double, 16> pixels = winogradSquare(products);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      double sum = 0;
      for (int i = 0; i < 9; ++i) {
        const int v = y + i / 3 - 1, u = x + i % 3 - 1;
        if (v >= 0 && u >= 0 && v < 4 && u < 4) sum += weights[i] * memory.at(op.input, v, u, 2);
      }
      EXPECT_NEAR(pixels[4 * y + x], sum, 1e-6) << y << " " << x;
    }
}

TEST(WinogradInput, RefusesOtherWidths) {
  EXPECT_NO_THROW(dispatch(inputOf({4, 8, 4}, DataType::f32), {}));
  EXPECT_THROW(dispatch(inputOf({4, 10, 4}, DataType::f32), {}), std::logic_error);
  EXPECT_THROW(dispatch(inputOf({4, 8, 4, {}, 5, true}, DataType::f32), {}), std::logic_error);
}

// More than a row of workgroups makes.
TEST(WinogradInput, LeavesTheWidestRowsToThePlainKernel) {
  const auto programOf = [](uint32_t width) {
    return dispatch(inputOf({4, width, 256}, DataType::f32), test::traitsOf(KernelFamily::lane)).program;
  };
  EXPECT_EQ(programOf(8192), "winograd_input_lane_f32");
  EXPECT_EQ(programOf(8196), "winograd_input_plain_f32");
}

}  // namespace
}  // namespace xrds::winograd_input_test
