#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/recording.h"
#include "graph/graph.h"

namespace xrds {

/// The views that an operator reads and writes.
struct OperatorViews {
  std::vector<TensorView> inputs;
  TensorView output;
};
OperatorViews viewsOf(const Node& node);

/// "256x256x32 -> 256x256x96".
std::string shapesText(const OperatorViews& views);

/// A graph of this node alone, with all values.
Graph single(const Graph& graph, const Node& node);

/// The device's result against the reference: RMS and largest difference, over the RMS of the reference.
struct OperatorError {
  double rms = 0, max = 0;
  bool finite = true, withinTolerance = false;
};

/// An operator placed in buffers of its own, its inputs filled with random numbers, the same on every machine; whatever
/// is only written holds NaN. Ready to be run at will.
class PlacedOperator {
 public:
  /// `graph` holds one node and outlives this. Throws Error if the operator's tensors take more than the device has.
  PlacedOperator(Gpu& gpu, const Graph& graph);

  const std::vector<PlacedDispatch>& dispatches() const { return dispatches_; }
  /// The output's elements after a run.
  std::vector<float> output() const { return read(viewsOf(graph_.nodes.front()).output); }
  /// Of the last run, against the reference on the same inputs. Slow: for small graphs.
  OperatorError error() const;

 private:
  void fill(ValueId value, DataType type, size_t elementCount, bool isRead);
  std::vector<float> read(const TensorView& view) const;

  Gpu& gpu_;
  const Graph& graph_;
  std::vector<std::unique_ptr<Buffer>> buffers_;  // by value
  std::vector<std::vector<float>> inputs_;        // rounded to their storage, by value; empty where nothing is read
  std::unique_ptr<Buffer> weights_;
  std::vector<PlacedDispatch> dispatches_;
};

}  // namespace xrds
