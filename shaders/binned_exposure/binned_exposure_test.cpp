#include "shaders/binned_exposure/binned_exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/harness.h"
#include "tests/print_case.h"

namespace xrds::binned_exposure_test {
namespace {

using test::PrintTo;
using test::radiances;
using test::view;

BinnedExposure exposureOf(uint32_t height, uint32_t width, DataType type = DataType::f32) {
  return {.colour = view(0, type, height, width, 4, 4, 12), .output = view(1, DataType::f32, 1, 1, 4, 8, 16)};
}

struct Shape {
  uint32_t height, width;
};

class BinnedExposureShapes : public testing::TestWithParam<Shape> {};

// The comparison is relative to the RMS of (e, 1 / e, count, 0): a dark image tests e, a bright one 1 / e.
TEST_P(BinnedExposureShapes, MatchesReference) {
  const auto [height, width] = GetParam();
  const size_t count = size_t{height} * width * 12;
  for (const float level : {1e-5f, 1.0f, 1e7f})
    test::expectMatchesReference(exposureOf(height, width), {{0, radiances(count, level)}});
  test::expectMatchesReference(exposureOf(height, width, DataType::f16), {{0, radiances(count, 1.0f)}});
}

// One pixel, thin images, whole bins, one pixel more and less; more bins than invocations.
INSTANTIATE_TEST_SUITE_P(All, BinnedExposureShapes,
                         testing::Values(Shape{1, 1}, Shape{1, 70}, Shape{33, 2}, Shape{16, 32}, Shape{17, 31},
                                         Shape{131, 127}, Shape{300, 290}));

TEST(BinnedExposure, OfAConstantImageIsTheKeyOverItsLuminance) {
  HostMemory memory;
  const BinnedExposure op = exposureOf(20, 33);
  for (uint32_t i = 0; i < 20 * 33; ++i)
    for (uint32_t c = 0; c < 3; ++c) memory.at(op.colour, i / 33, i % 33, c) = 0.36;
  reference(op, memory);
  EXPECT_NEAR(memory.at(op.output, 0, 0, 0), 0.5, 1e-12);
  EXPECT_NEAR(memory.at(op.output, 0, 0, 1), 2, 1e-12);
  EXPECT_EQ(memory.at(op.output, 0, 0, 2), 2 * 3);
}

// Dark bins, and what is no radiance, do not count; the largest floats do not make it infinite.
TEST(BinnedExposure, LeavesOutDarkBinsAndWhatIsNoRadiance) {
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> pixels(size_t{16} * 48 * 12, 0.0f);
  pixels[4] = nan;
  pixels[5] = -infinity;
  for (size_t x = 16; x < 32; ++x) pixels[12 * x + 4] = 0.5f;
  test::expectMatchesReference(exposureOf(16, 48), {{0, pixels}});
  pixels[12 * 40 + 5] = infinity;
  test::expectMatchesReference(exposureOf(16, 48), {{0, pixels}});
}

TEST(BinnedExposure, OfABlackImageIsOne) {
  HostMemory memory;
  reference(exposureOf(2, 2), memory);
  EXPECT_EQ(memory.at(exposureOf(2, 2).output, 0, 0, 0), 1);
  test::expectMatchesReference(exposureOf(2, 2), {{0, std::vector<float>(48, 0.0f)}});
}

TEST(BinnedExposure, RefusesWhatIsNoImage) {
  BinnedExposure op = exposureOf(4, 4);
  op.output = view(1, DataType::f32, 1, 2, 4);
  EXPECT_THROW(dispatch(op, {}), std::logic_error);
}

}  // namespace
}  // namespace xrds::binned_exposure_test
