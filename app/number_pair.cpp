#include "app/number_pair.h"

#include "image/leading_number.h"

namespace xrds {

std::optional<std::pair<double, double>> parsePair(const std::string& text) {
  std::pair<double, double> pair;
  const char *end = text.data() + text.size(), *at = text.data();
  for (double* number : {&pair.first, &pair.second}) {
    const auto found = leadingNumber(at, end);
    if (!found || !(found->value > 0)) return {};
    *number = found->value;
    const bool last = number == &pair.second;
    if (last ? found->end != end : found->end == end || *found->end != ',') return {};
    at = found->end + 1;
  }
  return pair;
}

std::string validPair(const std::string& text) {
  return parsePair(text) ? "" : "expected two positive numbers such as 64,16, found '" + text + "'";
}

}  // namespace xrds
