#include "image/leading_number.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

namespace xrds {
namespace {

bool isDigit(char character) { return character >= '0' && character <= '9'; }

const char* skipDigits(const char* at, const char* end) {
  while (at != end && isDigit(*at)) ++at;
  return at;
}

}  // namespace

std::optional<LeadingNumber> leadingNumberByHand(const char* begin, const char* end, bool exponents) {
  const char* const first = begin != end && *begin == '-' ? begin + 1 : begin;
  const char* at = skipDigits(first, end);
  auto digits = at - first;
  if (at != end && *at == '.') {
    const char* const fraction = at + 1;
    at = skipDigits(fraction, end);
    digits += at - fraction;
  }
  if (digits == 0) return {};
  if (exponents && at != end && (*at == 'e' || *at == 'E')) {
    const char* power = at + 1;
    if (power != end && (*power == '-' || *power == '+')) ++power;
    if (power != end && isDigit(*power)) at = skipDigits(power, end);
  }
  const double value = std::strtod(std::string(begin, at).c_str(), nullptr);
  if (!std::isfinite(value)) return {};
  return LeadingNumber{value, at};
}

std::optional<LeadingNumber> leadingNumber(const char* begin, const char* end, bool exponents) {
#ifdef __cpp_lib_to_chars
  double value = 0;
  const auto format = exponents ? std::chars_format::general : std::chars_format::fixed;
  const auto [rest, error] = std::from_chars(begin, end, value, format);
  if (error != std::errc{} || !std::isfinite(value)) return {};
  return LeadingNumber{value, rest};
#else
  return leadingNumberByHand(begin, end, exponents);
#endif
}

}  // namespace xrds
