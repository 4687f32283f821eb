#include "tuning/tuner.h"

#include <algorithm>
#include <chrono>
#include <set>

#include "frames/tile_choice.h"
#include "network/halo.h"
#include "tuning/frame_duel.h"
#include "tuning/kernel_trials.h"
#include "tuning/timing.h"

namespace xrds {
namespace {

constexpr double kLeastShare = 0.003;      // of a frame's time, for which an operator's other shapes are tried
constexpr uint32_t kPatienceSeconds = 60;  // for one kernel: less than one is usual

/// The device's patience with one kernel, as long as it lives.
class ShortPatience {
 public:
  explicit ShortPatience(Gpu& gpu) : gpu_(gpu) { gpu.setPatience(kPatienceSeconds); }
  ~ShortPatience() { gpu_.setPatience(kUsualPatienceSeconds); }
  ShortPatience(const ShortPatience&) = delete;
  ShortPatience& operator=(const ShortPatience&) = delete;

 private:
  Gpu& gpu_;
};

// Those that the device can run, and that are made for its kind.
std::vector<KernelFamily> familiesOf(const Gpu& gpu, Precision precision) {
  std::vector<KernelFamily> families{KernelFamily::plain};
  if (gpu.description().kind == DeviceKind::cpu) families.push_back(KernelFamily::lane);
  families.push_back(KernelFamily::tile);
  if (gpu.traits().matrixUnits != MatrixUnits::none && precision == Precision::fp16)
    families.push_back(KernelFamily::matrix);
  return families;
}

// The ways to write the graph, that of the fixed choice first.
std::vector<Form> formsOf(const Gpu& gpu, const NetworkModel& model, FrameShape frame, Precision precision) {
  const DeviceTraits& device = gpu.traits();
  std::vector<KernelTable> tables{{}};
  if (gpu.description().kind == DeviceKind::cpu)
    tables.push_back({.normsInLinear = device.family != KernelFamily::lane});
  if (device.matrixUnits != MatrixUnits::none && precision == Precision::fp16 && device.matrixSize.halfSums)
    tables.push_back({.layersFused = device.family != KernelFamily::fused});
  std::vector<Form> forms;
  for (const KernelTable& table : tables) forms.push_back(formOf(model, frame, precision, device, table));
  return forms;
}

// Every shape of the forms, those of the most work first.
std::vector<FormShape> shapesInOrder(const std::vector<Form>& forms) {
  std::vector<std::pair<uint64_t, FormShape>> found;
  std::set<std::string> seen;
  for (const Form& form : forms)
    for (const auto& [shape, nodes] : form.shapes)
      if (seen.insert(shape).second) found.push_back({form.workOf(shape), {shape, &form}});
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<FormShape> order;
  for (auto& [work, shape] : found) order.push_back(std::move(shape));
  return order;
}

// What a frame takes with the fastest kernels so far; nothing if an operator has none.
std::optional<double> timeOf(const Form& form, const KernelTrials& trials) {
  double sum = 0;
  for (const auto& [shape, nodes] : form.shapes) {
    const double best = trials.best(shape);
    if (best == 0) return std::nullopt;
    sum += form.frameTime(shape, best);
  }
  return sum;
}

const Form& bestForm(const std::vector<Form>& forms, const KernelTrials& trials) {
  const Form* chosen = &forms.front();
  auto least = timeOf(*chosen, trials);
  for (const Form& form : forms) {
    const auto time = timeOf(form, trials);
    if (!time || (least && *time >= (1 - Trial::kMargin) * *least)) continue;
    chosen = &form;
    least = time;
  }
  return *chosen;
}

// Of a frame that is cut into tiles, kernels are tried on the largest; of one that takes long, on its upper rows.
FrameShape cropOf(const Gpu& gpu, const NetworkModel& model, FrameShape frame, Precision precision) {
  constexpr double kLongSeconds = 4;
  constexpr uint32_t kFewRows = 64;
  const NetworkConfig& config = model.config();
  FrameShape crop = chooseTiles(model, frame, precision, {0, 0, boundedHalo(config)},
                                {gpu.description().memoryBytes / 4 * 3, gpu.traits()})
                        .crop;
  const auto work = [&] {
    const NodeCost sum = cost(buildGraph(config, crop, model.lookup(), fastOn(gpu.traits(), {.precision = precision})));
    return static_cast<double>(sum.multiplyAdds + sum.attentionMultiplyAdds);
  };
  while (gpu.pace().mean > 0 && crop.height > kFewRows && work() > kLongSeconds * gpu.pace().mean)
    crop.height = alignUp(crop.height / 2, config.window);
  return crop;
}

// First each family in the shape of its own rule, in all forms of the graph; then, in the best form, other shapes of
// the families that are near the best, and the winners against the fixed choice.
const Form& tryKernels(const std::vector<Form>& forms, KernelTrials& trials) {
  const std::vector<FormShape> all = shapesInOrder(forms);
  const auto shareOf = [](double begin, double end, size_t done, size_t count) {
    return begin + (end - begin) * static_cast<double>(done) / static_cast<double>(count);
  };
  trials.compile(all, false, 0, 0.2);
  for (size_t i = 0; i < all.size(); ++i) {
    std::optional<Trial> trial;
    trials.tryOpen(all[i], false, shareOf(0.2, 0.5, i, all.size()), trial);
  }
  const Form& form = bestForm(forms, trials);
  const double whole = timeOf(form, trials).value_or(0);
  std::vector<FormShape> those, weighty;
  for (const auto& [shape, nodes] : form.shapes) {
    those.push_back({shape, &form});
    if (form.frameTime(shape, trials.best(shape)) >= kLeastShare * whole && !trials.isDecided(shape))
      weighty.push_back(those.back());
  }
  trials.compile(weighty, true, 0.5, 0.65);
  for (size_t i = 0; i < those.size(); ++i) {
    if (trials.isDecided(those[i].shape)) continue;
    const double share = shareOf(0.65, 0.85, i, those.size());
    const bool weighs = std::any_of(weighty.begin(), weighty.end(),
                                    [&](const FormShape& each) { return each.shape == those[i].shape; });
    std::optional<Trial> trial;
    if (weighs) trials.tryOpen(those[i], true, share, trial);
    trials.tell(share, those[i].shape);
    trials.decide(those[i], trial);
  }
  return form;
}

// Of whole frames, unless both are the same or the fixed choice is wrong.
TunedFrame compareFrames(Gpu& gpu, const NetworkModel& model, FrameShape crop, const TuningOptions& options,
                         const TuningResult& result, const KernelTrials& trials) {
  TunedFrame frame{.taken = true,
                   .normsInLinear = result.table.normsInLinear,
                   .layersFused = result.table.layersFused,
                   .label = options.label};
  const bool fixedIsRight = std::all_of(result.shapes.begin(), result.shapes.end(), [](const TunedShape& shape) {
    return shape.winner.isFixed || shape.winner.fixedMicroseconds > 0;
  });
  if (result.table.isFixed() || !fixedIsRight) return frame;
  const auto report = [&] {
    trials.tell(0.9, "whole frames");
    return true;
  };
  const FrameDuel duel = frameDuel(gpu, model, crop, options.precision, result.table, report);
  frame.seconds = duel.seconds;
  frame.fixedSeconds = duel.fixedSeconds;
  frame.taken = duel.isSame && duel.seconds <= duel.fixedSeconds;
  return frame;
}

}  // namespace

TuningResult tune(Gpu& gpu, const NetworkModel& model, FrameShape frame, const TuningOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const uint32_t size = sizeClassOf(frame);
  KernelTrials trials(gpu, size, familiesOf(gpu, options.precision), options);
  const ShortPatience patience(gpu);
  const FrameShape crop = cropOf(gpu, model, frame, options.precision);
  const std::vector<Form> forms = formsOf(gpu, model, crop, options.precision);
  const Form& form = tryKernels(forms, trials);
  TuningResult result{.table = form.table, .shapes = tunedShapes(form, trials.record(), size)};
  for (const TunedShape& shape : result.shapes)
    if (!shape.winner.isFixed) result.table.kernels[shape.shape] = shape.winner.kernel;
  result.frame = compareFrames(gpu, model, crop, options, result, trials);
  result.frame.tuningSeconds = secondsSince(start);
  result.frame.date =
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  trials.keep(frameKey(model.config(), size, options.precision, gpu.traits().family), result.frame);
  if (!result.frame.taken) result.table = {};
  result.struckOff = trials.record().struckOff;
  result.measured = trials.measured();
  result.isKept = trials.isKept();
  return result;
}

}  // namespace xrds
