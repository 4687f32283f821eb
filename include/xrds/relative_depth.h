#pragma once

#include <span>
#include <vector>

#include "xrds/export.h"

namespace xrds {

/// The auxiliary image "depth" of models that take one, of the distances of all pixels of a frame in any unit: three
/// channels a pixel, d / (d + c m) for c = 1/4, 1 and 4 and the (lower) median m. Distances that are 0, negative, not
/// finite or at least 1e8 are background: they become 1 and do not count for the median.
XRDS_API std::vector<float> relativeDepth(std::span<const float> distances);

}  // namespace xrds
