#include "app/byte_count.h"

#include <charconv>
#include <cmath>

namespace xrds {

uint64_t parseBytes(const std::string& text) {
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || !(number > 0)) return 0;
  const std::string unit(rest, end);
  const size_t power = unit.empty() ? 0 : std::string("KMGT").find(unit[0]) + 1;
  const bool binary = unit.size() == 3 && unit.substr(1) == "iB";
  const bool known = unit.empty() || (power > 0 && (unit.size() == 1 || binary || unit.substr(1) == "B"));
  const double bytes = number * std::pow(binary ? 1024.0 : 1000.0, static_cast<double>(power));
  return known && bytes < 1e18 ? static_cast<uint64_t>(bytes) : 0;
}

std::string validBytes(const std::string& text) {
  return parseBytes(text) > 0 ? "" : "expected a number of bytes such as 256M or 2GiB, found '" + text + "'";
}

}  // namespace xrds
