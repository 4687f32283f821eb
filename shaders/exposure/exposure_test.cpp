#include "shaders/exposure/exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::exposure_test {
namespace {

using test::PrintTo;
using test::radiances;
using test::view;

Exposure exposureOf(uint32_t height, uint32_t width, DataType type = DataType::f32) {
  return {.colour = view(0, type, height, width, 4), .output = view(1, DataType::f32, 1, 1, 4)};
}

struct Shape {
  uint32_t height, width;
};

class ExposureShapes : public testing::TestWithParam<Shape> {};

// The comparison is relative to the RMS of (e, 1 / e, count, 0): a dark image tests e, a bright one 1 / e.
TEST_P(ExposureShapes, MatchesReference) {
  const auto [height, width] = GetParam();
  const size_t count = size_t{height} * width * 4;
  const Exposure op = exposureOf(height, width);
  for (const float level : {1e-5f, 1.0f, 1e7f}) test::expectMatchesReference(op, {{0, radiances(count, level)}});
  test::expectMatchesReference(exposureOf(height, width, DataType::f16), {{0, radiances(count, 1.0f)}});
}

INSTANTIATE_TEST_SUITE_P(All, ExposureShapes,
                         testing::Values(Shape{1, 1}, Shape{1, 3}, Shape{17, 15}, Shape{1, 256}, Shape{257, 1},
                                         Shape{131, 127}, Shape{200, 300}));

TEST(Exposure, ReadsASlice) {
  test::expectMatchesReference(
      Exposure{.colour = view(0, DataType::f32, 5, 7, 4, 4, 12), .output = view(1, DataType::f32, 1, 1, 4, 8, 16)},
      {{0, radiances(5 * 7 * 12, 1e-4f)}});
}

TEST(Exposure, OfAConstantImageIsTheKeyOverItsLuminance) {
  HostMemory memory;
  const Exposure op = exposureOf(3, 5);
  for (uint32_t i = 0; i < 15; ++i)
    for (uint32_t c = 0; c < 3; ++c) memory.at(op.colour, i / 5, i % 5, c) = 0.36;
  reference(op, memory);
  EXPECT_NEAR(memory.at(op.output, 0, 0, 0), 0.5, 1e-12);
  EXPECT_NEAR(memory.at(op.output, 0, 0, 1), 2, 1e-12);
  EXPECT_EQ(memory.at(op.output, 0, 0, 2), 15);
}

TEST(Exposure, LeavesOutBlackAndNonFinitePixels) {
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> pixels{1e-3f, 2e-3f, 3e-3f, 9,        1e-12f, 1e-12f, 1e-12f, 0,         nan, 1,
                                  1,     0,     1,     infinity, 1,      0,      1,      -infinity, 1,   0,
                                  -1,    -1,    -1,    0,        4e-3f,  1e-3f,  0,      nan};
  test::expectMatchesReference(exposureOf(1, 7), {{0, pixels}});
}

// As the network and its base image have it: what is negative is 0.
TEST(Exposure, CountsNegativeChannelsAsBlack) {
  const std::vector<float> pixels{0.5f, -2, 0.25f, 0, -1, 1, 2, 0, -3, -2, -1, 0, 0.1f, 0.2f, 0.3f, 0};
  std::vector<float> clamped = pixels;
  for (float& value : clamped) value = std::max(value, 0.0f);
  const Exposure op = exposureOf(1, 4);
  const auto onHost = [&](const std::vector<float>& values) {
    HostMemory memory;
    memory.storage(op.colour).assign(values.begin(), values.end());
    reference(op, memory);
    return memory.at(op.output, 0, 0, 0);
  };
  EXPECT_EQ(onHost(pixels), onHost(clamped));
  test::expectMatchesReference(op, {{0, pixels}});
}

double exposureOnHostOf(const std::vector<float>& luminances) {
  return automaticExposure(luminances.size(), [&](uint64_t i) { return double{luminances[i]}; }).exposure;
}

// The exposure of k times the image is e / k.
TEST(Exposure, FollowsTheScaleOfTheImage) {
  const auto pixels = radiances(40 * 30 * 4, 1);
  const Exposure op = exposureOf(30, 40);
  HostMemory memory;
  const auto exposureTimes = [&](double factor) {
    auto& stored = memory.storage(op.colour);
    for (size_t i = 0; i < pixels.size(); ++i) stored[i] = factor * pixels[i];
    reference(op, memory);
    return memory.at(op.output, 0, 0, 0);
  };
  const double exposure = exposureTimes(1);
  for (const float factor : {1e-20f, 1e-12f, 1e-6f, 1e6f, 1e20f}) {
    EXPECT_NEAR(exposureTimes(factor) * double{factor} / exposure, 1, 1e-12) << factor;
    auto scaled = pixels;
    for (float& value : scaled) value *= factor;
    test::expectMatchesReference(op, {{0, scaled}});
  }
}

// What is hardly lit does not count beside what is, and a firefly does not keep the rest from counting.
TEST(Exposure, IsThatOfTheLitPixels) {
  std::vector<float> luminances(1000, 1e-20f);
  std::fill_n(luminances.begin(), 100, 0.18f);
  EXPECT_NEAR(exposureOnHostOf(luminances), 1, 1e-6);
  std::fill(luminances.begin(), luminances.end(), 0.18f);
  luminances.front() = 1e30f;
  EXPECT_NEAR(exposureOnHostOf(luminances), std::pow(1e30 / 0.18, -1e-3), 1e-6);
}

// As the kernel, whose sums are floats: what is hardly a float does not count.
TEST(Exposure, LeavesOutTheLargestFloats) {
  const float largest = std::numeric_limits<float>::max();
  EXPECT_EQ(exposureOnHostOf({largest, largest}), 1);
  EXPECT_NEAR(exposureOnHostOf({largest, 0.36f}), 0.5, 1e-6);
  test::expectMatchesReference(exposureOf(1, 2), {{0, {largest, largest, largest, 0, 0.36f, 0.36f, 0.36f, 0}}});
}

TEST(Exposure, OfABlackImageIsOne) {
  HostMemory memory;
  reference(exposureOf(2, 2), memory);
  EXPECT_EQ(memory.at(exposureOf(2, 2).output, 0, 0, 0), 1);
  test::expectMatchesReference(exposureOf(2, 2), {{0, std::vector<float>(16, 0.0f)}});
}

TEST(Exposure, RefusesAHalfFloatResult) {
  Exposure op = exposureOf(2, 2);
  op.output.type = DataType::f16;
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::exposure_test
