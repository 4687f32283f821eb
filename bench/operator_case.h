#pragma once

#include <string>
#include <vector>

#include "engine/recording.h"
#include "graph/model.h"

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
std::vector<OperatorCase> distinctOperators(const std::string& network, const ModelWeights& model, uint32_t side,
                                            Precision precision, const DeviceTraits& device);

/// What one run of the operator multiplies and moves: its inputs and outputs and its weights, each counted once.
struct OperatorWork {
  uint64_t multiplyAdds = 0, byteSize = 0;
};

/// Throws std::logic_error if an operator binds a value that none of the fields known here names.
OperatorWork workOf(const OperatorCase& operatorCase, const DeviceTraits& device);

/// The device's result against the reference: RMS and largest difference, over the RMS of the reference.
struct OperatorError {
  double rms = 0, max = 0;
  bool withinTolerance = false;
};

/// Runs the small graph on the device and on the host, on the same random numbers. Whatever the kernel leaves unwritten
/// is NaN. Throws Error if Vulkan fails, std::logic_error if the device runs another kernel at full size.
OperatorError compareWithReference(Gpu& gpu, const OperatorCase& operatorCase);

/// An operator placed in buffers of its own at full size, its inputs filled, ready to be run at will.
class PlacedOperator {
 public:
  /// Throws Error if the operator's tensors take more than the device has.
  PlacedOperator(Gpu& gpu, const Graph& graph);

  const std::vector<PlacedDispatch>& dispatches() const { return dispatches_; }
  /// The numbers that the inputs hold, rounded to their storage, by value; empty where nothing is read.
  const std::vector<std::vector<float>>& inputs() const { return inputs_; }
  std::vector<float> read(const TensorView& view) const;

 private:
  void fill(ValueId value, DataType type, size_t elementCount, bool isRead);

  Gpu& gpu_;
  ValueId exposure_;
  std::vector<std::unique_ptr<Buffer>> buffers_;  // by value
  std::vector<std::vector<float>> inputs_;
  std::unique_ptr<Buffer> weights_;
  std::vector<PlacedDispatch> dispatches_;
};

}  // namespace xrds::bench
