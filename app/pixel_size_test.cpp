#include "app/pixel_size.h"

#include <gtest/gtest.h>

#include "app/exit_code.h"

namespace xrds {
namespace {

TEST(PixelSize, IsTwoNumbersWithinItsLimits) {
  EXPECT_EQ(parsePixelSize("1920x1080", "--size", 8, 16384), (PixelSize{1920, 1080}));
  EXPECT_EQ(parsePixelSize("8x16384", "--size", 8, 16384), (PixelSize{8, 16384}));
  for (const char* text : {"", "64", "64x", "x64", "64x64x", "64X64", " 64x64", "64x 64", "+64x64", "-64x64", "64.0x64",
                           "7x64", "64x16385", "99999999999x64"})
    try {
      parsePixelSize(text, "--live-size", 8, 16384);
      ADD_FAILURE() << text;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.code, ExitCode::usage);
      EXPECT_PRED_FORMAT2(testing::IsSubstring, "--live-size takes WIDTHxHEIGHT", failure.message);
      EXPECT_PRED_FORMAT2(testing::IsSubstring, "of 8 to 16384 pixels each, found '" + std::string(text) + "'.",
                          failure.message);
    }
}

}  // namespace
}  // namespace xrds
