#include "app/byte_count.h"

#include <cmath>

#include "image/leading_number.h"

namespace xrds {

uint64_t parseBytes(const std::string& text) {
  const char* const end = text.data() + text.size();
  const auto number = leadingNumber(text.data(), end);
  if (!number || !(number->value > 0)) return 0;
  const std::string unit(number->end, end);
  const size_t power = unit.empty() ? 0 : std::string("KMGT").find(unit[0]) + 1;
  const bool binary = unit.size() == 3 && unit.substr(1) == "iB";
  const bool known = unit.empty() || (power > 0 && (unit.size() == 1 || binary || unit.substr(1) == "B"));
  const double bytes = number->value * std::pow(binary ? 1024.0 : 1000.0, static_cast<double>(power));
  return known && bytes < 1e18 ? static_cast<uint64_t>(bytes) : 0;
}

std::string validBytes(const std::string& text) {
  return parseBytes(text) > 0 ? "" : "expected a number of bytes such as 256M or 2GiB, found '" + text + "'";
}

}  // namespace xrds
