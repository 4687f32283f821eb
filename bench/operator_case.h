#pragma once

#include <string>
#include <vector>

#include "checks/placed_operator.h"
#include "network/network_model.h"

namespace xrds::bench {

/// One of a network's distinct operators at the size to be timed, and the same step of a frame that is small enough for
/// its double-precision reference. Each graph holds this one node and all values.
struct OperatorCase {
  std::string name;    // "linear/compact/fp32/groups.0.xm.self_attn.qkv", of the first node that is like this
  std::string shapes;  // "256x256x32 -> 256x256x96"
  Graph graph, smallGraph;
  uint32_t nodesPerFrame = 0;  // that are like this

  const Node& node() const { return graph.nodes.front(); }
};

/// The distinct operators of a model's graph in order, for an output of `side` x `side` pixels. The model must outlive
/// the cases. Throws Error if the side is no multiple of the model's scale.
std::vector<OperatorCase> distinctOperators(const std::string& network, const NetworkModel& model, uint32_t side,
                                            Precision precision, const DeviceTraits& device);

/// What one run of the operator multiplies and moves: its inputs and outputs and its weights, each counted once.
struct OperatorWork {
  uint64_t multiplyAdds = 0;  // of the formula
  uint64_t products = 0;      // of the kernel, which may do with fewer
  uint64_t byteSize = 0;
};

/// Throws std::logic_error if an operator binds a value that none of the fields known here names.
OperatorWork workOf(const OperatorCase& operatorCase, const DeviceTraits& device);

/// Runs the small graph on the device and on the host, on the same random numbers. Whatever the kernel leaves unwritten
/// is NaN. Throws Error if Vulkan fails, std::logic_error if the device runs another kernel at full size.
OperatorError compareWithReference(Gpu& gpu, const OperatorCase& operatorCase);

}  // namespace xrds::bench
