#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace xrds {

/// "plain, lane, tile": the names with commas, as messages list them.
std::string listed(const std::vector<std::string>& names);

/// "1 scene", "3 scenes".
std::string counted(size_t count, const std::string& noun);

}  // namespace xrds
