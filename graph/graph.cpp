#include "graph/graph.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/work.h"
#include "shaders/common/groups.h"

namespace xrds {
namespace {

// Bindings start at an aligned offset at or below the first row, so one may exceed its rows by this much.
constexpr uint64_t kBindingSlack = kBindingAlignment;
constexpr uint64_t kStepRows = 16;  // of a dispatch in a multiple, so that its kernels' strips of rows stay whole

// First rows of the dispatches, and the end: each fits a binding and a dispatch's share of work.
template <class Op>
std::vector<uint32_t> dispatchBounds(const Op& op, const DeviceTraits& device, uint64_t multiplyAdds,
                                     uint64_t mostWork) {
  const RowRange rows = computedRows(op);
  const uint32_t count = rows.end - rows.begin;
  const uint64_t rowBytes = std::max<uint64_t>(1, op.output.rowByteSize() * shuffleFactor(op));
  const uint64_t rowWork = std::max<uint64_t>(1, workOf(multiplyAdds / count, rowBytes));
  uint64_t step = std::min((device.maxStorageBufferRange - kBindingSlack) / rowBytes, mostWork / rowWork);
  step = std::clamp<uint64_t>(step, 1, count);
  if (step < count && step > kStepRows) step = step / kStepRows * kStepRows;
  if constexpr (requires { Op::kRowUnit; }) step = std::max<uint64_t>(Op::kRowUnit, step / Op::kRowUnit * Op::kRowUnit);
  uint32_t first = rows.begin;
  std::vector<uint32_t> bounds{first};
  if constexpr (requires { op.shift; }) {  // whole windows: the rows above the shift belong to the wrapped ones
    if (step < count) {
      step = std::max<uint64_t>(op.window, step / op.window * op.window);
      first += (op.window + op.shift - first % op.window) % op.window;
    }
    if (first > rows.begin) bounds.push_back(first);
  }
  for (uint64_t row = first + step; row < rows.end; row += step) bounds.push_back(static_cast<uint32_t>(row));
  bounds.push_back(rows.end);
  return bounds;
}

bool isGridOfAnyDevice(const Dispatch& launch) {
  return std::all_of(launch.groupCount.begin(), launch.groupCount.end(),
                     [](uint32_t count) { return count <= kMaxGroupCount; });
}

// The dispatch of the operator's rows, or where devices would not take its grid, those of their halves.
template <class Op>
void addDispatches(uint32_t node, const std::string& label, Op op, const DeviceTraits& device,
                   std::vector<LoweredDispatch>& lowered) {
  Dispatch launch = launchOf(op, device);
  if constexpr (requires { op.rows; }) {
    const auto [begin, end] = computedRows(op);
    if (!isGridOfAnyDevice(launch) && end - begin > 1) {
      const uint32_t middle = begin + (end - begin) / 2;
      for (const RowRange half : {RowRange{begin, middle}, RowRange{middle, end}}) {
        op.rows = half;
        addDispatches(node, label, op, device, lowered);
      }
      return;
    }
  }
  launch.label = label;
  lowered.push_back({node, std::move(launch)});
}

}  // namespace

TensorView Graph::create(std::string name, DataType type, TensorShape shape) {
  values.push_back({std::move(name), type, shape});
  const auto id = static_cast<ValueId>(values.size() - 1);
  return {id, type, shape.height, shape.width, shape.channels, 0, shape.channels};
}

TensorView Graph::createRows(std::string name, DataType type, TensorShape shape, RowRange rows) {
  const uint32_t height = std::exchange(shape.height, rows.end - rows.begin);
  return asRowsOf(create(std::move(name), type, shape), height, rows.begin);
}

std::span<const float> Graph::keep(std::vector<float> weights) {
  madeWeights.push_back(std::make_shared<const std::vector<float>>(std::move(weights)));
  return *madeWeights.back();
}

DataType Graph::typeOf(const std::string& name, bool weights, DataType precision) const {
  for (const Promotion& promotion : promoted)
    if (promotion.weights == weights && promotion.name == name) return DataType::f32;
  return precision;
}

bool Graph::computesExposure() const {
  return std::any_of(nodes.begin(), nodes.end(), [](const Node& n) { return std::holds_alternative<Exposure>(n.op); });
}

std::vector<TensorView> Graph::inputs() const {
  std::vector<TensorView> views{colour};
  if (auxiliary.exists()) views.push_back(auxiliary);
  views.insert(views.end(), layers.begin(), layers.end());
  if (!computesExposure()) views.push_back(exposure);
  return views;
}

DeviceTraits traitsOf(const KernelChoice& kernel, DeviceTraits device) {
  device.family = kernel.family;
  device.shape = kernel.shape;
  if (kernel.shape.subgroup > 0) device.subgroupSize = kernel.shape.subgroup;
  return device;
}

DeviceTraits traitsOf(const Node& node, const DeviceTraits& device) {
  return node.kernel ? traitsOf(*node.kernel, device) : device;
}

Dispatch dispatchOf(const Node& node, const DeviceTraits& device) {
  return std::visit([traits = traitsOf(node, device)](const auto& op) { return launchOf(op, traits); }, node.op);
}

std::vector<float> packedWeightsOf(const Node& node, const DeviceTraits& device) {
  return std::visit([traits = traitsOf(node, device)](const auto& op) { return packedWeights(op, traits); }, node.op);
}

TensorView outputOf(const Node& node) {
  return std::visit([](const auto& op) { return op.output; }, node.op);
}

std::vector<Binding> bindingsOf(const Node& node) {
  return std::visit([](const auto& op) { return dispatch(op, DeviceTraits{}).bindings; }, node.op);
}

RowRange outputRows(const Node& node) {
  return std::visit(
      [](const auto& op) -> RowRange {
        const RowRange rows = computedRows(op);
        return {rows.begin * shuffleFactor(op), rows.end * shuffleFactor(op)};
      },
      node.op);
}

OperatorFacts factsOf(const Node& node) {
  return std::visit([](const auto& op) { return facts(op); }, node.op);
}

NodeCost cost(const Node& node) {
  const OperatorFacts facts = factsOf(node);
  return {facts.multiplyAdds, facts.attentionMultiplyAdds};
}

NodeCost cost(const Graph& graph) {
  NodeCost sum;
  for (const Node& node : graph.nodes) {
    const NodeCost part = cost(node);
    sum.multiplyAdds += part.multiplyAdds;
    sum.attentionMultiplyAdds += part.attentionMultiplyAdds;
  }
  return sum;
}

std::vector<LoweredDispatch> lower(const Graph& graph, const DeviceTraits& device, uint64_t mostWork) {
  std::vector<LoweredDispatch> lowered;
  for (uint32_t n = 0; n < graph.nodes.size(); ++n) {
    const Node& node = graph.nodes[n];
    const NodeCost work = cost(node);
    const DeviceTraits traits = traitsOf(node, device);
    const auto add = [&](const auto& op) { addDispatches(n, node.name, op, traits, lowered); };
    std::visit(
        [&](auto op) {
          if constexpr (requires { op.rows; }) {
            const auto bounds = dispatchBounds(op, device, work.multiplyAdds + work.attentionMultiplyAdds, mostWork);
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
  for (const TensorView& view : graph.layerMeans) touch(view.value, end);
  if (!graph.layerMeans.empty()) touch(graph.exposure.value, end);  // which is read after a run
  for (ValueId value = 0; value < lives.size(); ++value) {
    if (storage[value] == value) lives[value].byteSize = graph.values[value].byteSize();
    if (lives[value].firstUse == kUnused) lives[value].firstUse = 0;
  }
  return lives;
}

}  // namespace xrds
