#pragma once

#include <string>
#include <vector>

namespace xrds {

/// Prints one line for each on standard error.
void printWarnings(const std::vector<std::string>& warnings);

}  // namespace xrds
