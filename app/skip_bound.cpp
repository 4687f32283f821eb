#include "app/skip_bound.h"

#include <cstdlib>

#include "xrds/skip.h"

namespace xrds {

std::string validSkip(const std::string& text) {
  if (text == "off" || text == "safe") return {};
  char* end = nullptr;
  const float bound = std::strtof(text.c_str(), &end);
  return !text.empty() && *end == 0 && bound > 0 && bound <= 1
             ? ""
             : "expected off, safe or a number above 0, at most 1, found '" + text + "'";
}

float parseSkip(const std::string& text) {
  if (text == "off") return 0;
  return text == "safe" ? kSafeSkip : std::strtof(text.c_str(), nullptr);
}

}  // namespace xrds
