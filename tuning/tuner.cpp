#include "tuning/tuner.h"

#include <algorithm>
#include <chrono>

#include "frames/tile_choice.h"
#include "network/halo.h"
#include "tuning/frame_duel.h"
#include "tuning/trial.h"
#include "tuning/tuning_lock.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr double kNear = 1.3;  // other shapes of a family are tried if it takes at most so many times the best's time
constexpr uint32_t kPatienceSeconds = 60;  // for one kernel: less than one is usual

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Those that the device can run, and that are made for its kind.
std::vector<KernelFamily> familiesOf(const Gpu& gpu, Precision precision) {
  std::vector<KernelFamily> families{KernelFamily::plain};
  if (gpu.description().kind == DeviceKind::cpu) families.push_back(KernelFamily::lane);
  families.push_back(KernelFamily::tile);
  if (gpu.traits().matrixUnits != MatrixUnits::none && precision == Precision::fp16)
    families.push_back(KernelFamily::matrix);
  return families;
}

/// One tuning: the forms of a model's graph, and what is known of their kernels.
class Tuning {
 public:
  Tuning(Gpu& gpu, const NetworkModel& model, FrameShape frame, const TuningOptions& options)
      : gpu_(gpu),
        model_(model),
        options_(options),
        file_(tuningFileOf(gpu)),
        lock_(file_.path()),
        size_(sizeClassOf(frame)),
        families_(familiesOf(gpu, options.precision)) {
    if (!options.anew) record_ = file_.read();
    record_.dropStale([&](const std::string& name) { return xrds::stampOf(gpu_, name).hash; });
    record_.takeStock();
    file_.write(record_);
    chooseCrop(frame);
    writeForms();
  }

  TuningResult run() {
    const auto start = std::chrono::steady_clock::now();
    gpu_.setPatience(kPatienceSeconds);
    std::vector<std::pair<std::string, const Form*>> todo = shapesInOrder();
    compileFirst(todo);
    for (size_t i = 0; i < todo.size(); ++i) {
      const double share = 0.3 + 0.6 * static_cast<double>(i) / static_cast<double>(todo.size());
      tell(share, todo[i].first);
      tuneShape(todo[i].first, *todo[i].second, share);
    }
    TuningResult result = conclude(start);
    gpu_.setPatience(300);
    return result;
  }

 private:
  TrialKey keyOf(const std::string& shape) const { return {size_, shape}; }
  ProgramStamp stampOf(const std::string& program) const { return xrds::stampOf(gpu_, program); }

  void tell(double share, const std::string& text) const {
    if (options_.progress && !options_.progress({share, text}))
      throw Cancelled("The tuning was cancelled: nothing is wrong with the device.");
  }

  // Of a frame that is cut into tiles, kernels are tried on the largest.
  void chooseCrop(FrameShape frame) {
    const Cut whole{0, 0, boundedHalo(model_.config())};
    crop_ =
        chooseTiles(model_, frame, options_.precision, whole, {gpu_.description().memoryBytes / 4 * 3, gpu_.traits()})
            .crop;
  }

  void addForm(const KernelTable& table) {
    forms_.push_back(formOf(model_, crop_, options_.precision, gpu_.traits(), table));
  }

  // The first is the fixed choice's.
  void writeForms() {
    const DeviceTraits& device = gpu_.traits();
    const bool norms = device.family == KernelFamily::lane, fused = device.family == KernelFamily::fused;
    addForm({});
    if (gpu_.description().kind == DeviceKind::cpu) addForm({.normsInLinear = !norms});
    if (device.matrixUnits != MatrixUnits::none && options_.precision == Precision::fp16 && device.matrixSize.halfSums)
      addForm({.layersFused = !fused});
  }

  // Every shape of any form, those of the most work first.
  std::vector<std::pair<std::string, const Form*>> shapesInOrder() const {
    std::map<std::string, std::pair<uint64_t, const Form*>> found;
    for (const Form& form : forms_)
      for (const auto& [shape, nodes] : form.shapes)
        if (!found.contains(shape)) found[shape] = {form.workOf(shape), &form};
    std::vector<std::pair<std::string, const Form*>> order;
    for (const auto& [shape, each] : found) order.emplace_back(shape, each.second);
    std::stable_sort(order.begin(), order.end(),
                     [&](const auto& a, const auto& b) { return found.at(a.first).first > found.at(b.first).first; });
    return order;
  }

  std::vector<KernelCandidate> open(const std::string& shape, const Node& node, bool shapes) const {
    auto candidates = candidatesOf(node.op, gpu_.traits(), families_, shapes);
    std::erase_if(candidates, [&](const KernelCandidate& candidate) {
      return record_.findings.contains({keyOf(shape), candidate.kernel}) ||
             record_.isStruckOff(stampOf(candidate.dispatch.program));
    });
    return candidates;
  }

  // Runs what may end the process or lose the device, with a mark on the disk that says so.
  void marked(const std::string& program, const std::function<void()>& work) {
    record_.trying = stampOf(program);
    file_.write(record_);
    try {
      work();
    } catch (const DeviceLost& error) {
      record_.struckOff[program] = {stampOf(program).hash, error.what()};
      record_.trying.reset();
      file_.write(record_);
      throw DeviceLost("The kernel " + program + " lost the device and is struck off for its driver: " + error.what());
    } catch (...) {
      record_.trying.reset();
      file_.write(record_);
      throw;
    }
    record_.trying.reset();
  }

  // The kernels of all shapes, program by program: a driver compiles many at once.
  void compileFirst(const std::vector<std::pair<std::string, const Form*>>& todo) {
    std::map<std::string, std::vector<Dispatch>> programs;
    for (const auto& [shape, form] : todo) {
      const Node& node = form->nodeOf(shape);
      if (isDone(shape)) continue;
      for (const KernelCandidate& candidate : open(shape, node, false)) {
        Graph one = single(form->graph, node);
        one.nodes.front().kernel = candidate.kernel;
        for (LoweredDispatch& lowered : lower(one, gpu_.traits()))
          programs[lowered.dispatch.program].push_back(std::move(lowered.dispatch));
      }
    }
    size_t done = 0;
    for (const auto& [program, dispatches] : programs) {
      tell(0.3 * static_cast<double>(done++) / static_cast<double>(programs.size()), "compiling " + program);
      std::vector<const Dispatch*> launches;
      for (const Dispatch& dispatch : dispatches) launches.push_back(&dispatch);
      marked(program, [&] {
        try {
          compilePrograms(gpu_, launches);
        } catch (const Cancelled&) {
          throw;
        } catch (const DeviceLost&) {
          throw;
        } catch (const std::exception&) {  // the trial of each tells which does not compile
        }
      });
    }
  }

  bool isDone(const std::string& shape) const {
    const auto found = record_.winners.find(keyOf(shape));
    return found != record_.winners.end();
  }

  Finding tryKernel(Trial& trial, const KernelCandidate& candidate, double best) {
    Finding found{.program = stampOf(candidate.dispatch.program)};
    marked(candidate.dispatch.program, [&] {
      try {
        if (options_.beforeRun) options_.beforeRun(candidate.dispatch);
        found.why = trial.prove(candidate.kernel);
        found.right = found.why.empty();
        if (found.right) found.microseconds = trial.time(candidate.kernel, best);
      } catch (const Cancelled&) {
        throw;
      } catch (const DeviceLost&) {
        throw;
      } catch (const std::exception& error) {  // it does not compile, or breaks a limit of the device
        found = {.program = found.program, .why = error.what()};
      }
    });
    ++measured_;
    return found;
  }

  // The fastest kernel that is right; of a family, or of any.
  double best(const std::string& shape, std::optional<KernelFamily> family, KernelChoice* kernel = nullptr) const {
    double best = 0;
    for (auto each = record_.findings.lower_bound({keyOf(shape), {}});
         each != record_.findings.end() && each->first.first == keyOf(shape); ++each) {
      const auto& [choice, found] = std::pair(each->first.second, each->second);
      if (!found.right || (family && choice.family != *family) || record_.isStruckOff(found.program)) continue;
      if (best > 0 && found.microseconds >= best) continue;
      best = found.microseconds;
      if (kernel) *kernel = choice;
    }
    return best;
  }

  void tuneShape(const std::string& shape, const Form& form, double share) {
    if (isDone(shape)) return;
    const Node& node = form.nodeOf(shape);
    Trial trial(gpu_, single(form.graph, node));
    const auto tryAll = [&](const std::vector<KernelCandidate>& candidates, bool shapes) {
      for (const KernelCandidate& candidate : candidates) {
        if (shapes && candidate.kernel.shape != KernelShape{} &&
            !(best(shape, candidate.kernel.family) <= kNear * best(shape, {})))
          continue;
        tell(share, shape.substr(0, shape.find(" (")) + ", " + candidate.dispatch.program);
        record_.findings[{keyOf(shape), candidate.kernel}] = tryKernel(trial, candidate, best(shape, {}));
        file_.write(record_);
      }
    };
    tryAll(open(shape, node, false), false);
    tryAll(open(shape, node, true), true);
    decide(shape, node, trial);
  }

  // The winner must beat the fixed choice in turns, by more than noise.
  void decide(const std::string& shape, const Node& node, Trial& trial) {
    const KernelCandidate fixed = candidatesOf(node.op, gpu_.traits(), {}, false).front();
    KernelChoice kernel = fixed.kernel;
    const double fastest = best(shape, {}, &kernel);
    if (fastest == 0) return;  // none is right: the fixed choice's frame decides
    const auto known = record_.findings.find({keyOf(shape), fixed.kernel});
    const bool fixedIsRight = known != record_.findings.end() && known->second.right;
    Winner winner{.kernel = kernel, .microseconds = fastest};
    winner.fixedProgram = stampOf(fixed.dispatch.program);
    if (kernel == fixed.kernel || !fixedIsRight) {
      winner.fixedMicroseconds = fixedIsRight ? known->second.microseconds : 0;
    } else {
      const Trial::Duel duel = trial.duel(kernel, fixed.kernel);
      winner.microseconds = duel.isWon ? duel.microseconds : duel.otherMicroseconds;
      winner.fixedMicroseconds = duel.otherMicroseconds;
      if (!duel.isWon) winner.kernel = fixed.kernel;
    }
    winner.isFixed = winner.kernel == fixed.kernel;
    winner.program = winner.isFixed ? winner.fixedProgram : record_.findings.at({keyOf(shape), winner.kernel}).program;
    record_.winners[keyOf(shape)] = winner;
    file_.write(record_);
  }

  const Form& bestForm() const {
    const Form* chosen = &forms_.front();
    auto least = microsecondsOf(*chosen, record_, size_);
    for (const Form& form : forms_) {
      const auto time = microsecondsOf(form, record_, size_);
      if (!time || (least && *time >= (1 - Trial::kMargin) * *least)) continue;
      chosen = &form;
      least = time;
    }
    return *chosen;
  }

  TuningResult conclude(std::chrono::steady_clock::time_point start) {
    const Form& form = bestForm();
    TuningResult result{.table = form.table, .shapes = tunedShapes(form, record_, size_), .measured = measured_};
    for (const TunedShape& shape : result.shapes)
      if (!shape.winner.isFixed) result.table.kernels[shape.shape] = shape.winner.kernel;
    const std::string name = frameKey(model_.config(), size_, options_.precision, gpu_.traits().family);
    const auto known = record_.frames.find(name);
    if (measured_ == 0 && known != record_.frames.end()) {
      result.frame = known->second;
    } else {
      result.frame = compareFrames(result.table);
      result.frame.tuningSeconds = secondsSince(start);
      record_.frames[name] = result.frame;
      file_.write(record_);
    }
    result.struckOff = record_.struckOff;
    if (!result.frame.taken) result.table = {};
    return result;
  }

  TunedFrame compareFrames(const KernelTable& table) const {
    TunedFrame frame{.taken = true, .normsInLinear = table.normsInLinear, .layersFused = table.layersFused};
    frame.label = options_.label;
    frame.date =
        std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
    if (table.isFixed()) return frame;
    tell(0.9, "whole frames");
    const FrameDuel duel = frameDuel(gpu_, model_, crop_, options_.precision, table, [&] {
      return !options_.progress || options_.progress({0.95, "whole frames"});
    });
    frame.seconds = duel.seconds;
    frame.fixedSeconds = duel.fixedSeconds;
    frame.taken = duel.isSame && duel.seconds <= duel.fixedSeconds;
    return frame;
  }

  Gpu& gpu_;
  const NetworkModel& model_;
  const TuningOptions& options_;
  TuningFile file_;
  TuningLock lock_;
  uint32_t size_;
  std::vector<KernelFamily> families_;
  TuningRecord record_;
  FrameShape crop_;
  std::vector<Form> forms_;
  size_t measured_ = 0;
};

}  // namespace

TuningResult tune(Gpu& gpu, const NetworkModel& model, FrameShape frame, const TuningOptions& options) {
  return Tuning(gpu, model, frame, options).run();
}

}  // namespace xrds
