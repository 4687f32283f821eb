#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/recording.h"
#include "graph/graph.h"
#include "shaders/common/example.h"

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
  /// `graph` holds one node; `ranges`: of the numbers, by value, the usual one for what it leaves out. Throws Error if
  /// the operator's tensors take more than the device has.
  PlacedOperator(Gpu& gpu, Graph graph, std::vector<NumberRange> ranges = {});

  /// How another kernel makes the operator of the same inputs; no longer than this.
  struct Launch {
    std::unique_ptr<Buffer> weights;
    std::vector<PlacedDispatch> dispatches;
  };
  Launch launchOf(const std::optional<KernelChoice>& kernel);
  /// What the operator writes holds NaN again, or where it reads other parts of the same value what that held.
  void clearOutput();

  const std::vector<PlacedDispatch>& dispatches() const { return own_.dispatches; }
  /// The output's elements after a run.
  std::vector<float> output() const { return read(outputOf(graph_.nodes.front())); }
  /// Of the last run, against the reference on the same inputs. Slow: for small graphs.
  OperatorError error() const { return errorOf(output(), expected({outputRows(graph_.nodes.front())}).front()); }
  /// The same for some rows of the output alone, whose values in double precision are made once.
  struct Expected {
    RowRange rows;
    std::vector<double> values;
  };
  std::vector<Expected> expected(const std::vector<RowRange>& parts) const;
  /// Of an output() against them.
  OperatorError errorOf(const std::vector<float>& output, const Expected& expected) const;

 private:
  void fill(ValueId value, DataType type, size_t elementCount, bool isRead);
  std::vector<float> read(const TensorView& view) const;

  Gpu& gpu_;
  Graph graph_;
  std::vector<NumberRange> ranges_;               // by value
  std::vector<std::unique_ptr<Buffer>> buffers_;  // by value
  std::vector<std::vector<float>> inputs_;        // rounded to their storage, by value; empty where nothing is read
  Launch own_;
};

}  // namespace xrds
