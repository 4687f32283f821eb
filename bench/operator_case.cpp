#include "bench/operator_case.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "bench/timing.h"
#include "xrds/error.h"

namespace xrds::bench {
namespace {

// Sides of the low-resolution frame on which kernels are checked: with padding, and with several windows.
constexpr FrameShape kSmallFrame{13, 15};

using Signature = std::tuple<std::string, std::vector<uint32_t>, std::string, std::vector<uint32_t>>;

// Equal for nodes that run the same kernels on tensors of the same sizes and strides.
Signature signatureOf(const Graph& one, const Dispatch& first) {
  const OperatorViews views = viewsOf(one.nodes.front());
  std::vector<uint32_t> strides{views.output.channelStride};
  for (const TensorView& view : views.inputs) strides.push_back(view.channelStride);
  return {first.program, first.specialization, shapesText(views), strides};
}

}  // namespace

std::vector<OperatorCase> distinctOperators(const std::string& network, const NetworkModel& model, uint32_t side,
                                            Precision precision, const DeviceTraits& device) {
  const uint32_t scale = model.config().scale;
  if (side == 0 || side % scale != 0)
    throw Error("A side of " + std::to_string(side) + " pixels is no multiple of the scale " + std::to_string(scale) +
                " of network '" + network + "'.");
  const GraphOptions options =
      fastOn(device, {.precision = precision, .bandRows = kWholeFrame});  // with the same nodes
  const Graph full = buildGraph(model.config(), {side / scale, side / scale}, model.lookup(), options);
  const Graph small = buildGraph(model.config(), kSmallFrame, model.lookup(), options);
  XRDS_CHECK_EQ(full.nodes.size(), small.nodes.size());
  std::vector<OperatorCase> cases;
  std::map<Signature, size_t> known;
  for (size_t i = 0; i < full.nodes.size(); ++i) {
    Graph one = single(full, full.nodes[i]);
    const Dispatch first = lower(one, device).front().dispatch;
    const auto [at, added] = known.try_emplace(signatureOf(one, first), cases.size());
    if (added)
      cases.push_back(
          {.name = operatorOf(first.program) + "/" + network + "/" + nameOf(precision) + "/" + full.nodes[i].name,
           .shapes = shapesText(viewsOf(full.nodes[i])),
           .graph = std::move(one),
           .smallGraph = single(small, small.nodes[i])});
    ++cases[at->second].nodesPerFrame;
  }
  return cases;
}

OperatorWork workOf(const OperatorCase& operatorCase, const DeviceTraits& device) {
  const OperatorViews views = viewsOf(operatorCase.node());
  OperatorWork work;
  std::set<ValueId> named;
  std::set<std::tuple<ValueId, uint32_t, uint32_t>> counted;
  const auto count = [&](const TensorView& view) {
    named.insert(view.value);
    if (counted.emplace(view.value, view.channelOffset, view.channels).second)
      work.byteSize += view.pixelCount() * view.channels * byteSize(view.type);
  };
  for (const TensorView& view : views.inputs) count(view);
  count(views.output);
  DataType weightType = DataType::f32;
  for (const LoweredDispatch& lowered : lower(operatorCase.graph, device)) {
    work.multiplyAdds += lowered.dispatch.multiplyAdds;
    work.products += lowered.dispatch.multiplyAdds - lowered.dispatch.savedProducts;
    for (const Binding& binding : lowered.dispatch.bindings) {
      if (binding.value == kWeights)
        weightType = binding.type;
      else
        XRDS_CHECK(named.contains(binding.value));  // else a field is missing in viewsOf()
    }
  }
  std::visit([&](const auto& op) { work.byteSize += packedWeights(op, device).size() * byteSize(weightType); },
             operatorCase.node().op);
  return work;
}

OperatorError compareWithReference(Gpu& gpu, const OperatorCase& operatorCase) {
  const PlacedOperator placed(gpu, operatorCase.smallGraph);
  const Dispatch full = lower(operatorCase.graph, gpu.traits()).front().dispatch;
  // Specializations differ: subgroups are shared out evenly.
  XRDS_CHECK(placed.dispatches().front().dispatch.program == full.program);
  TimedRecording(gpu, placed.dispatches()).run();
  return placed.error();
}

}  // namespace xrds::bench
