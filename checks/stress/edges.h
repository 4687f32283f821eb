#pragma once

#include <string>
#include <vector>

#include "checks/stress/parts.h"

namespace xrds {

/// A change to the weights of a model that brings a part of it to the edge of what numbers can hold.
struct WeightEdge {
  std::string name;
  bool bounded = false;  // the network stays as well conditioned as it was: the bounds on its error still hold
  bool inShortForm = false;
  Parts parts = Parts::exactTiles;  // where frames are cut in one way of all: that of plain kernels in fp32
  TensorFile (*apply)(TensorFile file);
};

/// All changes, the first of which leaves the weights as they are. Those that scale values and divide by the same
/// power of two behind them leave the network's output as it was.
const std::vector<WeightEdge>& weightEdges();

/// A network that a stress run tries with random weights.
struct StressNetwork {
  std::string name;
  NetworkConfig config;
  bool inShortForm = false;  // together they have every operator, those of xrds with one group of one block
};

/// Of every scale, kind of block, way to join, base image and transfer, then the small one of each other architecture.
std::vector<StressNetwork> stressNetworks();

/// That of the name. Throws std::logic_error if there is none.
NetworkConfig stressConfig(const std::string& name);

}  // namespace xrds
