#pragma once

#include <string>
#include <vector>

namespace xrds {

/// The name that was probably meant by `typed`: the one of fewest slips, which are letters too many, missing, wrong or
/// swapped, at most a third of its length; or the first that begins with it. Empty if none is near.
std::string nearest(const std::string& typed, const std::vector<std::string>& names);

}  // namespace xrds
