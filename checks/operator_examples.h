#pragma once

#include <vector>

#include "graph/graph.h"
#include "network/precision.h"
#include "shaders/common/example.h"

namespace xrds {

/// An operator in a graph of its own, named after it, and what its values are filled with.
struct OperatorExample {
  Graph graph;
  std::vector<NumberRange> ranges;  // by value
};

/// The examples of every operator that the device makes.
std::vector<OperatorExample> operatorExamples(Precision precision, const DeviceTraits& device);

}  // namespace xrds
