#pragma once

#include <vector>

#include "graph/graph.h"

namespace xrds {

/// Of each value of a crop's graph, in pixels of the value: the first one, counted from an edge of the crop, that
/// equals the whole frame's; the inputs do everywhere. Crops begin and end at multiples of every operator's blocks.
/// Rows of bands are taken for the images that they are of. Pure.
std::vector<uint32_t> firstExactPixels(const Graph& graph);

}  // namespace xrds
