#include "engine/check.h"

#include <gtest/gtest.h>

#include <string>

namespace xrds {
namespace {

// Of the file no folder, which would be that of who built the program.
TEST(Check, TellsPlaceExpressionAndValues) {
  const int three = 3;
  const std::string line = std::to_string(__LINE__ + 2);
  try {
    XRDS_CHECK_EQ(three, 4);
    FAIL();
  } catch (const std::logic_error& error) {
    EXPECT_EQ(error.what(), "check_test.cpp:" + line + ": expected three == 4, found 3 and 4");
  }
}

}  // namespace
}  // namespace xrds
