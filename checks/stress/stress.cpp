#include "checks/stress/stress.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "checks/reference.h"
#include "checks/stress/edges.h"
#include "checks/stress/inputs.h"
#include "checks/stress/parts.h"
#include "frames/quiet_windows.h"
#include "network/halo.h"

namespace xrds {
namespace {

constexpr FrameShape kFrame{9, 7};  // more than one window of any model, and padding
constexpr size_t kFewReferences = 2;
constexpr float kScales[] = {1e-12f, 1e6f};  // of the colour, for two rows that share
constexpr float kLeastBinnedScale = 1e-4f;   // as binnedExposure() takes luminances below 1e-8 for black
constexpr double kScalingBound = 1e-3;       // in fp32; in fp16 two results are as far apart as rounding makes them

/// What double precision makes of a frame.
struct Reference {
  double exposure = 1;
  std::vector<double> output;  // [s h, s w, 4]
};

Reference referenceOf(const NetworkModel& model, const StressFrame& frame) {
  const Graph graph = buildGraph(model.config(), kFrame, model.lookup(), {});
  HostMemory memory;
  setInputs(graph, frame.input(true), memory);
  runReference(graph, memory);
  return {memory.storage(graph.exposure)[0], memory.storage(graph.output)};
}

// RMS of the difference over the RMS of the reference, in the transformed domain.
double relativeError(const std::vector<float>& output, const Reference& reference, Transfer transfer) {
  double difference = 0, power = 0;
  for (size_t i = 0; i < output.size(); ++i) {
    const double expected = transform(transfer, reference.output[i / 3 * 4 + i % 3] * reference.exposure);
    const double found = transform(transfer, output[i] * reference.exposure);
    difference += (found - expected) * (found - expected);
    power += expected * expected;
  }
  return power > 0 ? std::sqrt(difference / power) : std::sqrt(difference);
}

uint64_t countLit(const std::vector<float>& output) {
  uint64_t lit = 0;
  for (size_t i = 0; i < output.size(); i += 3) lit += output[i] != 0 || output[i + 1] != 0 || output[i + 2] != 0;
  return lit;
}

/// One way to make a session of a model.
struct Mode {
  bool autoExposure = true, banded = false, checksOperators = false;
  float colourScale = 1;  // with which the first frame is run once more
};

/// What a row tries. Where that is not all, two rows share it that differ in one thing alone: the second tries what the
/// first leaves out.
struct Scope {
  bool changed = false, large = false;  // the weights; the model
  bool second = false;
  Parts parts = Parts::exactTiles;  // how frames are cut where that is in one way
};

class StressRun {
 public:
  StressRun(Gpu& gpu, const StressOptions& options) : gpu_(gpu), options_(options), traits_(gpu.traits()) {
    report_.seed = options.seed;
    report_.fp32Bound = kNetworkBudget.fp32;
    report_.fp16Bound = kNetworkBudget.fp16;
    report_.fp32ScalingBound = kScalingBound;
    report_.fp16ScalingBound = kNetworkBudget.fp16;
    for (const StressInput& input : stressColours()) report_.colours.emplace_back(input.name);
    for (const StressInput& input : stressAuxiliaries()) report_.auxiliaries.emplace_back(input.name);
  }
  StressRun(const StressRun&) = delete;
  StressRun& operator=(const StressRun&) = delete;
  ~StressRun() { gpu_.setTraits(traits_); }

  StressReport run(const std::vector<StressModel>& models) {
    for (const StressModel& model : models)
      for (const WeightEdge& edge : weightEdges())
        for (const KernelFamily family : families()) rowCount_ += 2 * runs(model, edge, family);
    for (size_t i = 0; i < models.size(); ++i)
      if (!runModel(models[i], i)) break;
    return std::move(report_);
  }

 private:
  std::vector<KernelFamily> families() const {
    if (traits_.family == KernelFamily::plain) return {KernelFamily::plain};
    return {KernelFamily::plain, traits_.family};
  }

  // A large model, whose programs take seconds to make, is not tried in every way.
  bool runs(const StressModel& model, const WeightEdge& edge, KernelFamily family) const {
    if (options_.shortForm && !edge.inShortForm) return false;
    return !model.large || !isChange(edge) || (edge.bounded && family == traits_.family);
  }
  static bool isChange(const WeightEdge& edge) { return &edge != &weightEdges().front(); }

  // Returns false if it was stopped.
  bool runModel(const StressModel& model, size_t turn) {
    const NetworkConfig& config = model.weights.config();
    frames_ = stressFrames(config, kFrame, options_.seed, turn);
    partedFrames_ = stressFrames(config, partedFrame(config), options_.seed, turn);
    for (const WeightEdge& edge : weightEdges()) {
      if (!runs(model, edge, traits_.family)) continue;
      const NetworkModel weights = NetworkModel::fromTensors(edge.apply(model.weights.file()), model.name);
      references_.clear();
      for (const StressFrame& frame : frames_)
        if (frame.natural && (!(isChange(edge) || options_.shortForm) || references_.size() < kFewReferences))
          references_.push_back(referenceOf(weights, frame));
      for (const Precision precision : {Precision::fp32, Precision::fp16})
        for (const KernelFamily family : families()) {
          if (!runs(model, edge, family)) continue;
          StressRow row{model.name, edge.name, nameOf(precision), nameOf(family), edge.bounded};
          const Scope scope = scopeOf(model, edge, precision, family);
          runRow(weights, precision, family, scope, row);
          runParts(weights, precision, scope, row);
          report_.rows.push_back(std::move(row));
          const double done = static_cast<double>(report_.rows.size()) / static_cast<double>(rowCount_);
          if (options_.progress && !options_.progress(done)) return false;
        }
    }
    return true;
  }

  // The rows that share are those of two kernel families, or where one family runs, those of the precisions.
  Scope scopeOf(const StressModel& model, const WeightEdge& edge, Precision precision, KernelFamily family) const {
    const bool half = precision == Precision::fp16, devices = family == traits_.family && families().size() > 1;
    const bool sharedByFamilies = families().size() > 1 && runs(model, edge, KernelFamily::plain);
    const size_t parts = static_cast<size_t>(edge.parts) + 2 * half + devices;
    return {.changed = isChange(edge),
            .large = model.large,
            .second = sharedByFamilies ? devices : half,
            .parts = kAllParts[parts % std::size(kAllParts)]};
  }

  void runRow(const NetworkModel& weights, Precision precision, KernelFamily family, Scope scope, StressRow& row) {
    DeviceTraits traits = traits_;
    traits.family = family;
    gpu_.setTraits(traits);
    const bool devices = family == traits_.family, fewer = scope.changed && (scope.large || options_.shortForm);
    const bool shared = scope.changed || options_.shortForm;
    std::vector<Mode> modes{{.checksOperators = !fewer && (devices || !(scope.large || options_.shortForm)),
                             .colourScale = kScales[scope.second]}};
    if (!fewer && (devices || !scope.large)) {
      if (!shared || scope.second) modes.push_back({.autoExposure = false});
      if (!shared || !scope.second) modes.push_back({.banded = true});
    }
    std::vector<size_t> which;
    for (size_t i = 0; i < frames_.size(); ++i)
      if (!fewer || (frames_[i].natural ? i < kFewReferences : i % 2 == scope.second)) which.push_back(i);
    expected_.assign(frames_.size(), {});
    for (const Mode mode : modes) runMode(weights, precision, mode, which, row);
  }

  void runMode(const NetworkModel& weights, Precision precision, Mode mode, const std::vector<size_t>& which,
               StressRow& row) {
    const NetworkConfig& config = weights.config();
    Session session(gpu_, weights, kFrame,
                    {.precision = precision,
                     .autoExposure = mode.autoExposure,
                     .bandRows = mode.banded ? config.window : kWholeFrame,
                     .aliasing = !mode.checksOperators});
    row.promoted.clear();
    for (const Promotion& promotion : session.graph().promoted)
      row.promoted.push_back(promotion.name + (promotion.weights ? " (weights): " : ": ") + promotion.reason);
    std::vector<float> output(3 * session.graph().output.pixelCount()), first;
    size_t natural = 0;
    for (const size_t i : which) {
      const StressFrame& frame = frames_[i];
      session.run(frame.input(mode.autoExposure), output);
      count(frame, output, session.lostPixels().size(), row);
      if (frame.natural && mode.autoExposure) compareWithReference(frame, natural++, output, config.transfer, row);
      if (config.base != BaseImage::none && frame.isBlack()) row.litFromBlack += countLit(output);
      if (mode.autoExposure && !mode.banded) expected_[i] = output;
      if (mode.banded) row.bandsExactly = row.bandsExactly && output == expected_[i];
      if (i == 0) first = output;
      if (i == 0 && mode.checksOperators) checkOperators(session, precision, row);
    }
    session.run(frames_.front().input(mode.autoExposure), output);
    row.replaysExactly = row.replaysExactly && output == first;
    if (mode.autoExposure && !mode.banded) scaleColour(session, output, mode.colourScale, config.transfer, row);
  }

  // Frames in tiles and with windows skipped.
  void runParts(const NetworkModel& weights, Precision precision, Scope scope, StressRow& row) {
    if (row.family != nameOf(traits_.family) && (scope.large || options_.shortForm)) return;
    const bool fewer = scope.changed || options_.shortForm;
    std::vector<std::unique_ptr<PartRunner>> runners;
    for (const Parts parts : kAllParts) {
      if (fewer && parts != scope.parts) continue;
      if (parts == Parts::exactTiles && seesWholeFrame(weights.config())) continue;
      if (parts == Parts::skip && !whyNeverQuiet(weights.config()).empty()) continue;
      runners.push_back(std::make_unique<PartRunner>(gpu_, weights, precision, parts));
    }
    if (runners.empty()) return;
    Session session(gpu_, weights, partedFrame(weights.config()), {.precision = precision, .bandRows = kWholeFrame});
    std::vector<float> whole(3 * session.graph().output.pixelCount());
    const size_t turn = report_.rows.size();  // in the short form each row tries a fourth of the frames
    for (size_t i = 0; i < partedFrames_.size(); ++i) {
      if (options_.shortForm ? i % 4 != turn % 4 : fewer && i % 2 != scope.second) continue;
      session.run(partedFrames_[i].input(true), whole);
      count(partedFrames_[i], whole, session.lostPixels().size(), row);
      for (const auto& runner : runners) runInParts(*runner, partedFrames_[i], whole, row);
    }
  }

  static void runInParts(PartRunner& runner, const StressFrame& frame, const std::vector<float>& whole,
                         StressRow& row) {
    std::vector<float> output(whole.size());
    // Given exposures, too, are tried: with bounded tiles, which need not equal anything.
    const bool autoExposure = runner.parts() != Parts::boundedTiles;
    runner.run(frame, autoExposure, output);
    count(frame, output, runner.lostPixels(), row);
    ++row.casesInParts;
    if (runner.parts() == Parts::exactTiles) row.tilesExactly = row.tilesExactly && output == whole;
    if (runner.parts() == Parts::skip)
      row.worstSkip = std::max(row.worstSkip, runner.largestSkippedChange(output, whole));
    if (!frame.natural) return;
    std::vector<float> again(whole.size());
    runner.run(frame, autoExposure, again);
    row.replaysExactly = row.replaysExactly && again == output;
  }

  static void count(const StressFrame& frame, const std::vector<float>& output, uint64_t lostPixels, StressRow& row) {
    ++row.cases;
    row.nonFiniteOutputs += !std::all_of(output.begin(), output.end(), [](float v) { return std::isfinite(v); });
    row.repairedPixels += frame.repairedPixels;
    row.lostPixels += lostPixels;
  }

  void compareWithReference(const StressFrame& frame, size_t which, const std::vector<float>& output, Transfer transfer,
                            StressRow& row) {
    if (which >= references_.size()) return;
    ++row.naturalCases;
    const double error = relativeError(output, references_[which], transfer);
    if (error <= row.worstError) return;
    row.worstError = error;
    row.worstInput = frame.name;
  }

  // The first frame, whose result is `output`, once more with another unit of the colour.
  void scaleColour(Session& session, const std::vector<float>& output, float scale, Transfer transfer, StressRow& row) {
    StressFrame frame = frames_.front();
    if (frame.takesBinnedExposure) scale = std::max(scale, kLeastBinnedScale);
    Reference unscaled{session.exposure(), std::vector<double>(output.size() / 3 * 4)};
    for (size_t i = 0; i < output.size(); ++i) unscaled.output[i / 3 * 4 + i % 3] = output[i];
    frame.scaleLight(scale);
    std::vector<float> scaled(output.size());
    session.run(frame.input(true), scaled);
    for (float& value : scaled) value /= scale;
    row.worstScaling = std::max(row.worstScaling, relativeError(scaled, unscaled, transfer));
  }

  void checkOperators(const Session& session, Precision precision, StressRow& row) {
    const std::vector<Divergence> errors = operatorErrors(session);
    for (size_t n = 0; n < errors.size(); ++n) {
      const OperatorFacts facts = factsOf(session.graph().nodes[n]);
      const double budget = boundOf(facts.budget, precision);
      if (row.firstDegraded.empty() && !(errors[n].relativeRms <= budget)) row.firstDegraded = errors[n].node;
      if (!row.bounded) continue;
      StressOperator& op = operatorOf(std::string(facts.name), row, budget);
      if (errors[n].relativeRms <= op.worstError) continue;
      op.worstError = errors[n].relativeRms;
      op.where = row.model + " (" + row.weights + "), " + errors[n].node;
    }
  }

  StressOperator& operatorOf(const std::string& name, const StressRow& row, double budget) {
    for (StressOperator& op : report_.operators)
      if (op.name == name && op.precision == row.precision && op.family == row.family) return op;
    return report_.operators.emplace_back(StressOperator{name, row.precision, row.family, 0, budget, {}});
  }

  Gpu& gpu_;
  const StressOptions& options_;
  const DeviceTraits traits_;
  size_t rowCount_ = 0;
  std::vector<StressFrame> frames_, partedFrames_;
  std::vector<Reference> references_;         // of the first natural frames
  std::vector<std::vector<float>> expected_;  // of each frame, in one piece
  StressReport report_;
};

}  // namespace

StressReport runStress(Gpu& gpu, const std::vector<StressModel>& models, const StressOptions& options) {
  std::vector<StressModel> all;
  for (StressNetwork& network : stressNetworks()) {
    if (!options.randomModels || (options.shortForm && !network.inShortForm)) continue;
    if (options.shortForm && network.config.architecture == NetworkConfig{}.architecture)
      network.config.groups = network.config.blocks = 1;
    all.push_back({"random " + network.name, NetworkModel::random(network.config, options.seed)});
  }
  all.insert(all.end(), models.begin(), models.end());
  return StressRun(gpu, options).run(all);
}

}  // namespace xrds
