#pragma once

#include <string>
#include <vector>

namespace xrds {

/// "plain, lane, tile": the names with commas, as messages list them.
std::string listed(const std::vector<std::string>& names);

}  // namespace xrds
