#include "engine/half.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine_programs.h"
#include "tests/harness.h"

namespace xrds {
namespace {

TEST(Half, EveryHalfSurvivesTheRoundTrip) {
  for (uint32_t half = 0; half < 0x10000; ++half) {
    const float value = fromHalf(static_cast<uint16_t>(half));
    if (std::isnan(value))
      EXPECT_TRUE(std::isnan(fromHalf(toHalf(value))));
    else
      EXPECT_EQ(toHalf(value), half);
  }
}

TEST(Half, RoundsToTheNearestAndTiesToEven) {
  for (uint32_t half = 0; half < 0x7BFF; ++half) {
    const float below = fromHalf(static_cast<uint16_t>(half)), above = fromHalf(static_cast<uint16_t>(half + 1));
    const float middle = (below + above) / 2;  // exact: one bit more than a half has
    EXPECT_EQ(toHalf(middle), half + (half & 1)) << middle;
    EXPECT_EQ(toHalf(std::nextafter(middle, 0.0f)), half) << middle;
    EXPECT_EQ(toHalf(std::nextafter(middle, 1e30f)), half + 1) << middle;
    EXPECT_EQ(toHalf(-std::nextafter(middle, 1e30f)), (half + 1) | 0x8000u) << middle;
  }
}

TEST(Half, BeyondTheRangeIsInfinity) {
  EXPECT_EQ(toHalf(65519.99f), 0x7BFF);
  EXPECT_EQ(toHalf(65520.0f), 0x7C00);
  EXPECT_EQ(toHalf(-1e30f), 0xFC00);
}

// Devices may round packHalf2x16 as they like; the tolerance for f16 counts on an error below one step.
TEST(Half, DeviceStoresWithinOneStep) {
  const size_t quads = 1024;
  std::vector<float> numbers = test::randomNumbers(quads * 4, 1);
  numbers[0] = 1.0f + 0x1.8p-11f;  // three quarters of a step: up if rounded, down if truncated
  numbers[1] = 1.0f + 0x1p-11f;    // a tie
  numbers[2] = 1.0f + 0x1p-10f + 0x1p-11f;
  Buffer buffer(test::gpu(), quads * 24);
  test::uploadFloats(buffer, 0, numbers);
  const PlacedDispatch toHalfs = test::toHalfs(buffer, 0, quads * 16, quads);
  Recording(test::gpu(), {&toHalfs, 1}).run();
  std::vector<uint16_t> halfs(quads * 4);
  buffer.download(quads * 16, std::as_writable_bytes(std::span(halfs)));

  size_t nearest = 0;
  for (size_t i = 0; i < halfs.size(); ++i) {
    nearest += halfs[i] == toHalf(numbers[i]);
    EXPECT_LE(std::abs(int{halfs[i]} - int{toHalf(numbers[i])}), 1) << numbers[i];
  }
  RecordProperty("roundedToNearest", static_cast<int>(nearest));
}

// Infinity would make NaN of the sums that read it.
TEST(Half, DeviceStoresTheLargestHalfForWhatIsLarger) {
  const std::vector<float> numbers{65504, 65519, 65520, 1e30f, -65520, -1e30f, INFINITY, NAN};
  const std::vector<uint16_t> expected{0x7BFF, 0x7BFF, 0x7BFF, 0x7BFF, 0xFBFF, 0xFBFF, 0x7BFF};
  Buffer buffer(test::gpu(), 512);
  test::uploadFloats(buffer, 0, numbers);
  const PlacedDispatch toHalfs = test::toHalfs(buffer, 0, 256, 2);
  Recording(test::gpu(), {&toHalfs, 1}).run();
  std::vector<uint16_t> halfs(8);
  buffer.download(256, std::as_writable_bytes(std::span(halfs)));
  EXPECT_TRUE(std::isnan(fromHalf(halfs.back())));
  halfs.pop_back();
  EXPECT_EQ(halfs, expected);
}

}  // namespace
}  // namespace xrds
