#pragma once

#include <vector>

#include "graph/graph.h"
#include "network/precision.h"

namespace xrds {

/// The examples of every operator that the device makes, each in a graph of its own, named after the operator.
std::vector<Graph> operatorExamples(Precision precision, const DeviceTraits& device);

}  // namespace xrds
