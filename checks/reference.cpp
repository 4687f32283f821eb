#include "checks/reference.h"

#include <cmath>

namespace xrds {
namespace {

Divergence compare(const Node& node, const auto& found, HostMemory& memory) {
  const TensorView view = outputOf(node);
  Divergence result{node.name};
  double difference = 0, power = 0;
  const RowRange rows = outputRows(node);
  for (uint64_t p = view.storedRow(rows.begin) * view.width; p < view.storedRow(rows.end) * view.width; ++p)
    for (uint32_t c = 0; c < view.channels; ++c) {
      const uint64_t at = p * view.channelStride + view.channelOffset + c;
      const double expected = memory.storage(view)[at];
      result.finite = result.finite && std::isfinite(found[at]);
      difference += (found[at] - expected) * (found[at] - expected);
      power += expected * expected;
    }
  result.relativeRms = power > 0 ? std::sqrt(difference / power) : std::sqrt(difference);
  return result;
}

}  // namespace

void runReference(const Graph& graph, HostMemory& memory, const std::function<bool(const Node&)>& visit) {
  for (const Node& node : graph.nodes) {
    std::visit([&](const auto& op) { reference(op, memory); }, node.op);
    if (visit && !visit(node)) return;
  }
}

void setInputs(const Graph& graph, const FrameInput& input, HostMemory& memory) {
  const auto set = [&](const TensorView& view, uint32_t offset, const PixelView& image) {
    for (uint64_t p = 0; p < view.pixelCount(); ++p)
      for (uint32_t c = 0; c < 3; ++c)
        memory.storage(view)[p * view.channelStride + offset + c] = image.pixels[p * image.stride + c];
  };
  set(graph.colour, 0, input.colour);
  for (size_t i = 0; i < input.auxiliary.size(); ++i)
    set(graph.auxiliary, static_cast<uint32_t>(3 * i), input.auxiliary[i]);
  for (size_t i = 0; i < input.layers.size(); ++i) set(graph.layers[i], 0, input.layers[i].image);
  if (!graph.computesExposure()) {
    auto& exposure = memory.storage(graph.exposure);
    exposure[0] = input.exposure.value_or(FrameExposure{}).value;
    exposure[1] = 1 / exposure[0];
  }
}

std::vector<Divergence> operatorErrors(const Session& session) {
  const Graph& graph = session.graph();
  HostMemory memory;
  for (ValueId id = 0; id < graph.values.size(); ++id) {
    const Value& value = graph.values[id];
    const auto [height, width, channels] = value.shape;
    const std::vector<float> found = session.read({id, value.type, height, width, channels, 0, channels});
    memory.storage(id, found.size()).assign(found.begin(), found.end());
  }
  std::vector<Divergence> errors;
  for (const Node& node : graph.nodes) {
    std::vector<double>& stored = memory.storage(outputOf(node));
    const std::vector<double> found = stored;
    std::visit([&](const auto& op) { reference(op, memory); }, node.op);
    errors.push_back(compare(node, found, memory));
    stored = found;
  }
  return errors;
}

CheckResult checkAgainstReference(Gpu& gpu, const NetworkModel& model, FrameShape frame, const FrameInput& input,
                                  SessionOptions options) {
  options.aliasing = false;
  Session session(gpu, model, frame, options);
  std::vector<float> output(3 * session.graph().output.pixelCount());
  session.run(input, output);
  HostMemory memory;
  setInputs(session.graph(), input, memory);
  CheckResult result{{}, -1, boundOf(kChainBudget, options.precision)};
  runReference(session.graph(), memory, [&](const Node& node) {
    result.nodes.push_back(compare(node, session.read(outputOf(node)), memory));
    const Divergence& last = result.nodes.back();
    if (result.firstDivergent < 0 && (!last.finite || !(last.relativeRms <= result.bound)))
      result.firstDivergent = static_cast<int>(result.nodes.size()) - 1;
    return true;
  });
  return result;
}

}  // namespace xrds
