#pragma once

#include <functional>

#include "checks/error_budget.h"
#include "frames/session.h"

namespace xrds {

/// Runs the graph in double precision on the host, each node by its operator's reference(). `inputs` gives the
/// elements of the graph's inputs as Session uploads them; `visit`, if given, is called after each node and stops the
/// run by returning false. Slow: for checks and tests.
void runReference(const Graph& graph, HostMemory& memory, const std::function<bool(const Node&)>& visit = {});

/// Puts a frame into the inputs of the graph, as Session::run does on the device.
void setInputs(const Graph& graph, const FrameInput& input, HostMemory& memory);

/// How far a device's values are from the reference at one node.
struct Divergence {
  std::string node;
  double relativeRms = 0;  // RMS of the difference over RMS of the reference
  bool finite = true;
};

/// The error of each node alone, in order: the node's reference on what the device gave it, against what the device
/// made of that, after a run of a session without aliasing.
std::vector<Divergence> operatorErrors(const Session& session);

/// How far a frame on the device is from its reference, node by node.
struct CheckResult {
  std::vector<Divergence> nodes;  // in order
  int firstDivergent = -1;        // index into nodes; -1: none exceeds the bound
  double bound = 0;
};

/// Replays a frame on the device with every value kept, and in double precision on the host, and compares node by
/// node. Bound: that of the ledger for chains of operators.
CheckResult checkAgainstReference(Gpu& gpu, const NetworkModel& model, FrameShape frame, const FrameInput& input,
                                  SessionOptions options);

}  // namespace xrds
