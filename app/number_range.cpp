#include "app/number_range.h"

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

#include "image/leading_number.h"

namespace xrds {

CLI::Validator numberIn(double low, double high) {
  std::ostringstream range, words;
  range << "FLOAT in [" << low << " - " << high << "]";
  words << "expected a number from " << low << " to " << high;
  const auto check = [low, high, expected = words.str()](const std::string& text) {
    const char* end = text.data() + text.size();
    const auto found = leadingNumber(text.data(), end);
    const bool fits = found && found->end == end && found->value >= low && found->value <= high;
    return fits ? std::string() : expected + ", found '" + text + "'";
  };
  return CLI::Validator(check, range.str());
}

}  // namespace xrds
