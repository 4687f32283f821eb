#pragma once

#include <optional>

namespace xrds {

struct LeadingNumber {
  double value = 0;
  const char* end = nullptr;  // behind its last character
};

/// The finite number that the characters from `begin` to `end` start with, as std::from_chars() reads it: no blanks, no
/// plus sign. Nothing if there is none. `exponents`: whether 1e3 is a thousand, or 1 with "e3" behind it. For the C
/// locale. Safe from several threads.
std::optional<LeadingNumber> leadingNumber(const char* begin, const char* end, bool exponents = true);

/// The same where the standard library has no std::from_chars() for fractions (libc++ before version 20).
std::optional<LeadingNumber> leadingNumberByHand(const char* begin, const char* end, bool exponents = true);

}  // namespace xrds
