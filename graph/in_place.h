#pragma once

#include "graph/graph.h"

namespace xrds {

/// Which storage each value uses: itself, or the value whose bytes it continues. A residual sum is written over its
/// residual when nothing reads that afterwards and the value of the sum begins with it; a tensor that is made in bands
/// over the one that each band is made of, when no band reads rows that an earlier one wrote. Pure.
std::vector<ValueId> inPlaceStorage(const Graph& graph);

}  // namespace xrds
