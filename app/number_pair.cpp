#include "app/number_pair.h"

#include <charconv>
#include <cmath>

namespace xrds {

std::optional<std::pair<double, double>> parsePair(const std::string& text) {
  std::pair<double, double> pair;
  const char *end = text.data() + text.size(), *at = text.data();
  for (double* number : {&pair.first, &pair.second}) {
    const auto [rest, error] = std::from_chars(at, end, *number);
    if (error != std::errc{} || !(*number > 0) || !std::isfinite(*number)) return {};
    const bool last = number == &pair.second;
    if (last ? rest != end : rest == end || *rest != ',') return {};
    at = rest + 1;
  }
  return pair;
}

std::string validPair(const std::string& text) {
  return parsePair(text) ? "" : "expected two positive numbers such as 64,16, found '" + text + "'";
}

}  // namespace xrds
