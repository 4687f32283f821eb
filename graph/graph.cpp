#include "graph/graph.h"

#include <algorithm>
#include <numeric>

namespace xrds {
namespace {

constexpr uint64_t kMaxMultiplyAddsPerDispatch = uint64_t{8} << 30;
// Bindings start at an aligned offset at or below the first row, so a band may exceed its rows by this much.
constexpr uint64_t kBindingSlack = kBindingAlignment;

// The views of a node's bindings tell what it reads and writes; any traits will do for that.
std::vector<Binding> bindingsOf(const Node& node) {
  return std::visit([](const auto& op) { return dispatch(op, DeviceTraits{}).bindings; }, node.op);
}

// Rows that the operator's `rows` count: those of its output, before a pixel shuffle.
template <class Op>
uint32_t rowCount(const Op& op) {
  if constexpr (requires { op.shuffleOutput; }) return op.output.height / (op.shuffleOutput ? 2 : 1);
  return op.output.height;
}

// First rows of the bands, and the end: each band fits a binding and a dispatch's share of work.
template <class Op>
std::vector<uint32_t> bandBounds(const Op& op, const DeviceTraits& device, uint64_t multiplyAdds) {
  const uint32_t rows = rowCount(op);
  const uint64_t rowBytes = std::max<uint64_t>(1, op.output.storedByteSize() / rows);
  const uint64_t rowWork = std::max<uint64_t>(1, multiplyAdds / rows);
  uint64_t step =
      std::min((device.maxStorageBufferRange - kBindingSlack) / rowBytes, kMaxMultiplyAddsPerDispatch / rowWork);
  step = std::clamp<uint64_t>(step, 1, rows);
  uint32_t first = 0;
  std::vector<uint32_t> bounds{0};
  if constexpr (requires { op.shift; }) {  // whole windows: the rows above the shift belong to the wrapped ones
    if (step < rows) step = std::max<uint64_t>(op.window, step / op.window * op.window), first = op.shift;
    if (first > 0) bounds.push_back(first);
  }
  for (uint64_t row = first + step; row < rows; row += step) bounds.push_back(static_cast<uint32_t>(row));
  bounds.push_back(rows);
  return bounds;
}

bool sameBytes(const TensorView& a, const TensorView& b) {
  return a.type == b.type && a.shape() == b.shape() && a.channelOffset == 0 && b.channelOffset == 0 &&
         a.channelStride == a.channels && b.channelStride == b.channels;
}

// The residual of the node and its output, if writing over the residual keeps every other value intact.
struct ResidualSum {
  TensorView residual, output;
};
ResidualSum residualSum(const Node& node) {
  return std::visit(
      [](const auto& op) -> ResidualSum {
        if constexpr (requires { op.residual; }) return {op.residual, op.output};
        return {};
      },
      node.op);
}

}  // namespace

TensorView Graph::create(std::string name, DataType type, TensorShape shape) {
  values.push_back({std::move(name), type, shape});
  const auto id = static_cast<ValueId>(values.size() - 1);
  return {id, type, shape.height, shape.width, shape.channels, 0, shape.channels};
}

bool Graph::computesExposure() const {
  return std::any_of(nodes.begin(), nodes.end(), [](const Node& n) { return std::holds_alternative<Exposure>(n.op); });
}

std::vector<TensorView> Graph::inputs() const {
  std::vector<TensorView> views{colour};
  if (auxiliary.exists()) views.push_back(auxiliary);
  if (!computesExposure()) views.push_back(exposure);
  return views;
}

NodeCost cost(const Node& node) {
  if (const auto* op = std::get_if<Linear>(&node.op))
    return {op->output.pixelCount() * op->input.channels * op->output.channels, 0};
  if (const auto* op = std::get_if<Conv3x3>(&node.op)) {
    const uint64_t pixels = op->output.pixelCount() / (op->shuffleOutput ? 4 : 1);
    return {pixels * 9 * op->inputChannels * op->outputChannels, 0};
  }
  if (const auto* op = std::get_if<WindowAttention>(&node.op))
    return {0, 2 * op->output.pixelCount() * op->window * op->window * op->output.channels};
  return {};
}

std::vector<LoweredDispatch> lower(const Graph& graph, const DeviceTraits& device) {
  std::vector<LoweredDispatch> lowered;
  for (uint32_t n = 0; n < graph.nodes.size(); ++n) {
    const Node& node = graph.nodes[n];
    const NodeCost work = cost(node);
    const auto add = [&](const auto& op) {
      lowered.push_back({n, dispatch(op, device)});
      lowered.back().dispatch.label = node.name;
    };
    std::visit(
        [&](auto op) {
          if constexpr (requires { op.rows; }) {
            const auto bounds = bandBounds(op, device, work.multiplyAdds + work.attentionMultiplyAdds);
            for (size_t i = 0; i + 1 < bounds.size(); ++i) {
              op.rows = {bounds[i], bounds[i + 1]};
              add(op);
            }
          } else {
            add(op);
          }
        },
        node.op);
  }
  return lowered;
}

std::vector<ValueId> inPlaceStorage(const Graph& graph) {
  std::vector<uint32_t> lastRead(graph.values.size(), 0);
  for (uint32_t n = 0; n < graph.nodes.size(); ++n)
    for (const Binding& binding : bindingsOf(graph.nodes[n]))
      if (binding.value != kWeights && binding.access == Access::read) lastRead[binding.value] = n;

  std::vector<ValueId> storage(graph.values.size());
  std::iota(storage.begin(), storage.end(), ValueId{0});
  for (uint32_t n = 0; n < graph.nodes.size(); ++n) {
    const auto [residual, output] = residualSum(graph.nodes[n]);
    if (!residual.exists() || !sameBytes(residual, output) || lastRead[residual.value] != n) continue;
    uint32_t readsOfResidual = 0;  // as the convolution's input, say: then neighbours would see the sum
    for (const Binding& binding : bindingsOf(graph.nodes[n])) readsOfResidual += binding.value == residual.value;
    if (readsOfResidual == 1) storage[output.value] = storage[residual.value];
  }
  return storage;
}

std::vector<Lifetime> lifetimes(const Graph& graph, const std::vector<ValueId>& storage) {
  constexpr uint32_t kUnused = ~0u;
  std::vector<Lifetime> lives(graph.values.size(), {kUnused, 0, 0, kBindingAlignment});
  const auto touch = [&](ValueId value, uint32_t step) {
    Lifetime& life = lives[storage[value]];
    life.firstUse = std::min(life.firstUse, step);
    life.lastUse = std::max(life.lastUse, step);
  };
  for (const TensorView& view : graph.inputs()) touch(view.value, 0);
  for (uint32_t n = 0; n < graph.nodes.size(); ++n)
    for (const Binding& binding : bindingsOf(graph.nodes[n]))
      if (binding.value != kWeights) touch(binding.value, n + 1);
  const auto end = static_cast<uint32_t>(graph.nodes.size() + 1);
  touch(graph.output.value, end);
  for (ValueId value = 0; value < lives.size(); ++value) {
    if (storage[value] == value) lives[value].byteSize = graph.values[value].byteSize();
    if (lives[value].firstUse == kUnused) lives[value].firstUse = 0;
  }
  return lives;
}

}  // namespace xrds
