#include "image/leading_number.h"

#include <gtest/gtest.h>

#include <string>

namespace xrds {
namespace {

using Read = std::optional<LeadingNumber> (*)(const char*, const char*, bool);

void expectNumber(const std::string& text, double value, size_t length, bool exponents = true) {
  for (const Read read : {&leadingNumber, &leadingNumberByHand}) {
    const auto found = read(text.data(), text.data() + text.size(), exponents);
    ASSERT_TRUE(found) << text;
    EXPECT_EQ(found->value, value) << text;
    EXPECT_EQ(static_cast<size_t>(found->end - text.data()), length) << text;
  }
}

TEST(LeadingNumber, EndsBeforeWhatIsNoPartOfIt) {
  expectNumber("64", 64, 2);
  expectNumber("256M", 256, 3);
  expectNumber("2e", 2, 1);
  expectNumber("2e+", 2, 1);
  expectNumber("1.5e3B", 1500, 5);
  expectNumber("1E-2", 0.01, 4);
  expectNumber("-0.25,3", -0.25, 5);
  expectNumber(".5", 0.5, 2);
  expectNumber("5.", 5, 2);
  expectNumber("0x10", 0, 1);
  expectNumber("1.2.3", 1.2, 3);
  expectNumber("0.1", 0.1, 3);
}

TEST(LeadingNumber, TakesExponentsOnlyWhereAsked) { expectNumber("1e3", 1, 1, false); }

TEST(LeadingNumber, IsNothingWhereThereIsNone) {
  for (const std::string text : {"", "-", ".", "+1", " 1", "e3", "G", "inf", "nan", "1e999"})
    for (const Read read : {&leadingNumber, &leadingNumberByHand})
      EXPECT_FALSE(read(text.data(), text.data() + text.size(), true)) << text;
}

}  // namespace
}  // namespace xrds
