#include "api/examination.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <numeric>
#include <set>

#include "checks/known_frame.h"
#include "checks/operator_examples.h"
#include "checks/placed_operator.h"
#include "engine/kernel_family.h"
#include "frames/session.h"
#include "shaders/common/tolerance.h"

namespace xrds {
namespace {

// Of the low-resolution frame from which kernels are taken: with padding, and with several windows.
constexpr FrameShape kFrame{13, 15};
constexpr double kFrameBounds[] = {1e-4, 5e-3};  // fp32, fp16

class Stopwatch {
 public:
  double microseconds() const {
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Also for NaN, of which no two are equal as numbers.
bool sameBits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

double timeRun(Recording& recording) {
  const Stopwatch stopwatch;
  recording.run();
  const auto times = recording.gpuMicroseconds();
  return times.empty() ? stopwatch.microseconds() : std::accumulate(times.begin(), times.end(), 0.0);
}

KernelExamination examine(Gpu& gpu, const Graph& graph, const std::vector<NumberRange>& ranges, uint32_t runs) {
  const PlacedOperator placed(gpu, graph, ranges);
  const Node& node = graph.nodes.front();
  const Tolerance tolerance = toleranceOf(outputOf(node).type);
  KernelExamination found{.program = placed.dispatches().front().dispatch.program,
                          .node = node.name,
                          .shapes = shapesText(viewsOf(node)),
                          .rmsBound = tolerance.rms,
                          .maxBound = tolerance.max};
  Recording recording(gpu, placed.dispatches(), {.timestamps = true});
  found.microseconds = timeRun(recording);
  const std::vector<float> first = placed.output();
  for (uint32_t run = 1; run < runs; ++run) {
    found.microseconds = std::min(found.microseconds, timeRun(recording));
    found.repeatable = found.repeatable && sameBits(placed.output(), first);
  }
  const OperatorError error = placed.error();
  found.rms = error.rms;
  found.max = error.max;
  found.finite = error.finite;
  return found;
}

}  // namespace

std::vector<KernelExamination> examineKernels(Gpu& gpu, Precision precision, uint32_t runs) {
  const NetworkModel model = KnownFrame().model();
  std::vector<std::pair<Graph, std::vector<NumberRange>>> examples;  // of one node each
  std::vector<LoweredDispatch> dispatches;
  std::set<std::pair<std::string, std::vector<uint32_t>>> known;
  const auto add = [&](const Graph& graph, const std::vector<NumberRange>& ranges) {
    for (const Node& node : graph.nodes) {
      Graph one = single(graph, node);
      const std::vector<LoweredDispatch> lowered = lower(one, gpu.traits());
      const Dispatch& first = lowered.front().dispatch;
      if (!known.emplace(first.program, first.specialization).second) continue;
      dispatches.insert(dispatches.end(), lowered.begin(), lowered.end());
      examples.emplace_back(std::move(one), ranges);
    }
  };
  add(buildGraph(model.config(), kFrame, model.lookup(), fastOn(gpu.traits(), {.precision = precision})), {});
  for (const auto& [graph, ranges] : operatorExamples(precision, gpu.traits())) add(graph, ranges);

  std::vector<const Dispatch*> programs;
  for (const LoweredDispatch& lowered : dispatches) programs.push_back(&lowered.dispatch);
  compilePrograms(gpu, programs);
  std::vector<KernelExamination> kernels;
  for (const auto& [graph, ranges] : examples) kernels.push_back(examine(gpu, graph, ranges, runs));
  return kernels;
}

FrameExamination examineKnownFrame(Gpu& gpu, Precision precision, uint32_t runs) {
  const KnownFrame known;
  const uint32_t scale = known.model().config().scale;
  FrameExamination found{.width = scale * known.shape().width,
                         .height = scale * known.shape().height,
                         .rmsBound = kFrameBounds[static_cast<size_t>(precision)]};
  Session session(gpu, known.model(), known.shape(), {.precision = precision});
  session.fillArena(0x7fc00000);  // NaN, so that a kernel that leaves something out is found
  std::vector<float> first(KnownFrame::answer().size()), again(first.size());
  for (uint32_t run = 0; run < std::max(runs, 1u); ++run) {
    const Stopwatch stopwatch;
    session.run(known.input(), run == 0 ? first : again);
    const double time = stopwatch.microseconds();
    found.microseconds = run == 0 ? time : std::min(found.microseconds, time);
    found.repeatable = found.repeatable && (run == 0 || sameBits(again, first));
  }
  double squares = 0, power = 0;
  for (size_t i = 0; i < first.size(); ++i) {
    const double expected = KnownFrame::answer()[i];
    found.finite = found.finite && std::isfinite(first[i]);
    squares += (first[i] - expected) * (first[i] - expected);
    power += expected * expected;
  }
  found.rms = std::sqrt(squares / power);
  return found;
}

DeviceCapabilities capabilitiesOf(const Gpu& gpu) {
  const DeviceTraits& traits = gpu.traits();
  return {.kernelFamily = nameOf(traits.family),
          .matrixUnits = nameOf(gpu.description().matrixUnits),
          .matrixTrusted = traits.matrixUnits != MatrixUnits::none,
          .subgroupSize = traits.subgroupSize,
          .int64 = traits.shaderInt64,
          .timestamps = gpu.hasTimestamps(),
          .maxBindingBytes = traits.maxStorageBufferRange,
          .maxTensorTexels = traits.maxTexelBufferElements};
}

}  // namespace xrds
