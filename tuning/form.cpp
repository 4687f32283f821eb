#include "tuning/form.h"

#include <algorithm>

namespace xrds {
namespace {

uint64_t pixelsOf(const Node& node) {
  return std::visit([](const auto& op) { return computedPixels(op); }, node.op);
}

}  // namespace

const Node& Form::nodeOf(const std::string& shape) const {
  const auto& nodes = shapes.at(shape);
  const uint32_t largest = *std::max_element(nodes.begin(), nodes.end(), [&](uint32_t a, uint32_t b) {
    return pixelsOf(graph.nodes[a]) < pixelsOf(graph.nodes[b]);
  });
  return graph.nodes[largest];
}

uint64_t Form::workOf(const std::string& shape) const {
  uint64_t work = 0;
  for (const uint32_t n : shapes.at(shape)) {
    const NodeCost part = cost(graph.nodes[n]);
    work += part.multiplyAdds + part.attentionMultiplyAdds;
  }
  return work;
}

double Form::frameTime(const std::string& shape, double microseconds) const {
  const auto pixels = static_cast<double>(pixelsOf(nodeOf(shape)));
  double sum = 0;
  for (const uint32_t n : shapes.at(shape))
    sum += microseconds * static_cast<double>(pixelsOf(graph.nodes[n])) / pixels;
  return sum;
}

Form formOf(const NetworkModel& model, FrameShape frame, Precision precision, const DeviceTraits& device,
            const KernelTable& table) {
  const GraphOptions options{.precision = precision, .kernels = table};
  Form form{table, buildGraph(model.config(), frame, model.lookup(), fastOn(device, options)), {}};
  for (uint32_t n = 0; n < form.graph.nodes.size(); ++n)
    if (const Node& node = form.graph.nodes[n]; !dispatchOf(node, device).isCopy())
      form.shapes[operatorKey(node.op)].push_back(n);
  return form;
}

std::vector<TunedShape> tunedShapes(const Form& form, const TuningRecord& record, uint32_t size) {
  std::vector<TunedShape> shapes;
  for (const auto& [shape, nodes] : form.shapes) {
    const TrialKey key{size, shape};
    const auto winner = record.winners.find(key);
    if (winner == record.winners.end()) continue;
    TunedShape& tuned = shapes.emplace_back(TunedShape{shape, static_cast<uint32_t>(nodes.size()), winner->second});
    tuned.seconds = 1e-6 * form.frameTime(shape, winner->second.microseconds);
    tuned.fixedSeconds = 1e-6 * form.frameTime(shape, winner->second.fixedMicroseconds);
    for (auto each = record.findings.lower_bound({key, {}}); each != record.findings.end() && each->first.first == key;
         ++each) {
      ++tuned.tried;
      if (!each->second.right) tuned.wrong.push_back(each->second.program.name + ": " + each->second.why);
    }
  }
  std::stable_sort(shapes.begin(), shapes.end(),
                   [](const TunedShape& a, const TunedShape& b) { return a.seconds > b.seconds; });
  return shapes;
}

}  // namespace xrds
