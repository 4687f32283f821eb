#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graph/planner.h"
#include "shaders/operators.h"

namespace xrds {

/// One step of the forward pass.
struct Node {
  std::string name;  // the layer's name in the weight file, or the operator's
  Operator op;
  std::optional<KernelChoice> kernel{};  // which makes it; none: that of the device's family
};

/// A stored tensor; its index in Graph::values is its ValueId.
struct Value {
  std::string name;
  DataType type = DataType::f32;
  TensorShape shape;
  uint64_t byteSize() const { return uint64_t{shape.height} * shape.width * shape.channels * xrds::byteSize(type); }
  uint64_t texelCount() const { return uint64_t{shape.height} * shape.width * shape.channels / 4; }
};

/// Something of an fp16 graph that is stored in fp32, and why.
struct Promotion {
  std::string name;  // of a value, or of the layer whose weights it is
  bool weights = false;
  std::string reason;
};

/// The forward pass of one frame shape: values and the steps that compute them, in order.
struct Graph {
  std::vector<Value> values;
  std::vector<Node> nodes;
  TensorView colour;     // input [h, w, 4] f32: linear radiance, 4th channel 0
  TensorView auxiliary;  // input [s h, s w, ceil4(A)] f32, AOVs packed in the model's order; absent without inputs
  TensorView exposure;   // input or computed [1, 1, 4] f32: (e, 1/e, count, 0)
  TensorView network;    // the network's raw output, padded; absent without a network or where bands of it are made
  TensorView output;     // [s h, s w, 4] f32: linear radiance; 4th channel 1 where the network's share was left out
  std::vector<TensorView> layers;      // inputs, [h, w, 4] f32 each: what the base's kernels are applied to as well
  std::vector<TensorView> layerMeans;  // [s h, s w, 4] f32: what they make of each
  std::vector<Promotion> promoted;     // what fp16 does not store
  std::vector<std::shared_ptr<const std::vector<float>>> madeWeights;  // that operators refer to, shared with copies

  /// Adds a value and returns the view of all of it.
  TensorView create(std::string name, DataType type, TensorShape shape);
  /// Adds a value that stores these rows alone, and returns the view of the whole image.
  TensorView createRows(std::string name, DataType type, TensorShape shape, RowRange rows);
  /// Keeps weights that were made of the model's as long as the graph or a copy of it.
  std::span<const float> keep(std::vector<float> weights);
  std::vector<TensorView> inputs() const;
  /// The type of a value, or of a layer's weights, in a graph of that precision.
  DataType typeOf(const std::string& name, bool weights, DataType precision) const;
  bool computesExposure() const;
};

/// What the node's operator states of itself.
OperatorFacts factsOf(const Node& node);

/// The device as a kernel takes it, and as the node's does: with its choice, if there is one.
DeviceTraits traitsOf(const KernelChoice& kernel, DeviceTraits device);
DeviceTraits traitsOf(const Node& node, const DeviceTraits& device);

/// The launch of an operator, in subgroups of the size that is asked for. Pure.
template <class Op>
Dispatch launchOf(const Op& op, const DeviceTraits& device) {
  Dispatch launch = dispatch(op, device);
  if (launch.subgroupSize == 0) launch.subgroupSize = device.shape.subgroup;
  return launch;
}

/// The launch of the whole node, and the weights that it reads. Pure.
Dispatch dispatchOf(const Node& node, const DeviceTraits& device);
std::vector<float> packedWeightsOf(const Node& node, const DeviceTraits& device);

/// The output view of a node, and the rows of it that the node computes.
TensorView outputOf(const Node& node);
RowRange outputRows(const Node& node);

/// Multiplications of a node: of linear maps and convolutions, and of the token pairs in attention.
struct NodeCost {
  uint64_t multiplyAdds = 0, attentionMultiplyAdds = 0;
};
NodeCost cost(const Node& node);
NodeCost cost(const Graph& graph);  // the sum of its nodes

/// One dispatch of a node; a node becomes several where its output exceeds what the device can bind at once, or its
/// work what a dispatch may do.
struct LoweredDispatch {
  uint32_t node = 0;
  Dispatch dispatch;
};

inline constexpr uint64_t kMostWorkPerDispatch = uint64_t{8} << 30;

/// The dispatches of the graph in order, each of at most that much work (see workOf()) where rows, or rows of windows,
/// can be cut so finely. Pure.
std::vector<LoweredDispatch> lower(const Graph& graph, const DeviceTraits& device,
                                   uint64_t mostWork = kMostWorkPerDispatch);

/// When each storage holds bytes: step 0 is the upload of inputs, step i + 1 is node i, the last step is the download
/// of the output. Values that continue another have size 0. Pure.
std::vector<Lifetime> lifetimes(const Graph& graph, const std::vector<ValueId>& storage);

}  // namespace xrds
