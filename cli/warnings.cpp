#include "cli/warnings.h"

#include <cstdio>

namespace xrds {

void printWarnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) std::fprintf(stderr, "xrds: warning: %s\n", warning.c_str());
}

}  // namespace xrds
