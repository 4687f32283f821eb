#pragma once

#include <string>
#include <vector>

#include "graph/graph.h"

namespace xrds {

/// Finds what 16 bits cannot store of a graph, from its weights alone: the means and variances of all activations are
/// carried through `graph`, the fp32 graph of any frame shape, from those of natural inputs (independent channels,
/// fully correlated neighbours). In fp32 belong
/// - values that come near the largest half or stay below the smallest normal one,
/// - inputs of a layer norm whose mean over the channels drowns their spread,
/// - queries and keys whose products are so large that rounding them changes the softmax,
/// - weights that a half cannot hold to half a unit in the last place.
/// Pure; takes about as long as reading the weights twice.
std::vector<Promotion> findPromotions(const Graph& graph);

}  // namespace xrds
