#include "tuning/kernel_trials.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "xrds/error.h"

namespace xrds {
namespace {

constexpr double kNear = 1.3;  // other shapes of a family are tried if it takes at most so many times the best's time

// What the device's failure, or the caller's wish, is passed on as; all else is the kernel's own fault.
template <class Work, class Fault>
void blamingKernel(Work&& work, Fault&& fault) {
  try {
    work();
  } catch (const Cancelled&) {
    throw;
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    fault(error);
  }
}

}  // namespace

KernelTrials::KernelTrials(Gpu& gpu, uint32_t size, std::vector<KernelFamily> families, const TuningOptions& options)
    : gpu_(gpu),
      size_(size),
      families_(std::move(families)),
      options_(options),
      file_(tuningFileOf(gpu)),
      lock_(file_.path()) {
  if (!options.anew) record_ = knownRecord(gpu);
  record_.takeStock();
  save();
}

void KernelTrials::tell(double share, const std::string& text) const {
  if (options_.progress && !options_.progress({share, text}))
    throw Cancelled("The tuning was cancelled: nothing is wrong with the device.");
}

std::vector<KernelCandidate> KernelTrials::open(const FormShape& shape, bool shapes) const {
  auto candidates = candidatesOf(shape.node().op, gpu_.traits(), families_, shapes);
  std::erase_if(candidates, [&](const KernelCandidate& candidate) {
    const bool isFar = candidate.kernel.shape != KernelShape{} &&
                       !(best(shape.shape, candidate.kernel.family) <= kNear * best(shape.shape));
    return isFar || record_.findings.contains({keyOf(shape.shape), candidate.kernel}) ||
           record_.isStruckOff(stampOf(gpu_, candidate.dispatch.program));
  });
  return candidates;
}

KernelCandidate KernelTrials::fixedOf(const FormShape& shape) const {
  return candidatesOf(shape.node().op, gpu_.traits(), {}, false).front();
}

void KernelTrials::marked(const std::string& program, bool isFixed, const std::function<void()>& work) {
  const auto finish = [&] {
    record_.trying.reset();
    save();
  };
  record_.trying = stampOf(gpu_, program);
  record_.isFixedTried = isFixed;
  save();
  try {
    work();
  } catch (const DeviceLost& error) {
    record_.struckOff[program] = {stampOf(gpu_, program).hash, error.what()};
    finish();
    throw DeviceLost("The kernel " + program + " lost the device and is struck off for this driver: " + error.what());
  } catch (...) {
    finish();
    throw;
  }
  record_.trying.reset();  // on the disk with what comes next
}

void KernelTrials::compile(const std::vector<FormShape>& todo, bool shapes, double share, double endShare) {
  std::map<std::string, std::vector<Dispatch>> programs;
  std::set<std::string> fixed;
  for (const FormShape& each : todo) {
    fixed.insert(fixedOf(each).dispatch.program);
    for (const KernelCandidate& candidate : open(each, shapes)) {
      Graph one = single(each.form->graph, each.node());
      one.nodes.front().kernel = candidate.kernel;
      for (LoweredDispatch& lowered : lower(one, gpu_.traits()))
        programs[lowered.dispatch.program].push_back(std::move(lowered.dispatch));
    }
  }
  const double step = (endShare - share) / static_cast<double>(programs.size() + 1);
  for (const auto& [program, dispatches] : programs) {
    tell(share += step, "compiling " + program);
    std::vector<const Dispatch*> launches;
    for (const Dispatch& dispatch : dispatches) launches.push_back(&dispatch);
    // The trial of each tells which does not compile.
    marked(program, fixed.contains(program),
           [&] { blamingKernel([&] { compilePrograms(gpu_, launches); }, [](const std::exception&) {}); });
    save();  // the caller may cancel next, and nothing is wrong with this program
  }
}

Finding KernelTrials::tried(Trial& trial, const KernelCandidate& candidate, bool isFixed, double best) {
  Finding found{.program = stampOf(gpu_, candidate.dispatch.program)};
  marked(candidate.dispatch.program, isFixed, [&] {
    blamingKernel(
        [&] {
          if (options_.beforeRun) options_.beforeRun(candidate.dispatch);
          const Trial::Proof proof = trial.prove(candidate.kernel);
          found.why = proof.why;
          found.right = found.why.empty();
          if (found.right) found.microseconds = trial.time(candidate.kernel, best, proof.microseconds);
        },
        [&](const std::exception& error) { found = {.program = found.program, .why = error.what()}; });
  });
  record_.suspects.erase(candidate.dispatch.program);
  ++measured_;
  return found;
}

void KernelTrials::tryOpen(const FormShape& shape, bool shapes, double share, std::optional<Trial>& trial) {
  const std::string fixed = fixedOf(shape).dispatch.program;
  for (const KernelCandidate& candidate : open(shape, shapes)) {
    if (record_.isStruckOff(stampOf(gpu_, candidate.dispatch.program))) continue;
    tell(share, shape.shape.substr(0, shape.shape.find(" (")) + ", " + candidate.dispatch.program);
    if (!trial) trial.emplace(gpu_, single(shape.form->graph, shape.node()));
    record_.findings[{keyOf(shape.shape), candidate.kernel}] =
        tried(*trial, candidate, candidate.dispatch.program == fixed, best(shape.shape));
    save();
  }
}

double KernelTrials::best(const std::string& shape, std::optional<KernelFamily> family) const {
  for (const auto& [microseconds, kernel] : fastest(shape))
    if (!family || kernel.family == *family) return microseconds;
  return 0;
}

std::vector<std::pair<double, KernelChoice>> KernelTrials::fastest(const std::string& shape) const {
  std::vector<std::pair<double, KernelChoice>> right;
  for (auto each = record_.findings.lower_bound({keyOf(shape), {}});
       each != record_.findings.end() && each->first.first == keyOf(shape); ++each)
    if (each->second.right && !record_.isStruckOff(each->second.program))
      right.emplace_back(each->second.microseconds, each->first.second);
  std::sort(right.begin(), right.end());
  return right;
}

void KernelTrials::decide(const FormShape& shape, std::optional<Trial>& trial) {
  constexpr size_t kMostDuels = 3;
  const TrialKey key = keyOf(shape.shape);
  const KernelCandidate fixed = fixedOf(shape);
  const auto right = fastest(shape.shape);
  if (right.empty()) return;
  Winner winner;
  winner.fixedProgram = stampOf(gpu_, fixed.dispatch.program);
  std::tie(winner.microseconds, winner.kernel) = right.front();
  const auto own =
      std::find_if(right.begin(), right.end(), [&](const auto& each) { return each.second == fixed.kernel; });
  if (own != right.end()) {  // else the fixed choice is wrong
    std::tie(winner.fixedMicroseconds, winner.kernel) = *own;
    winner.microseconds = winner.fixedMicroseconds;
    for (size_t i = 0; i < std::min(kMostDuels, static_cast<size_t>(own - right.begin())); ++i) {
      if (right[i].first >= (1 - Trial::kMargin) * own->first) break;
      if (!trial) trial.emplace(gpu_, single(shape.form->graph, shape.node()));
      const Trial::Duel duel = trial->duel(right[i].second, fixed.kernel);
      if (!duel.isWon) continue;
      winner.kernel = right[i].second;
      winner.microseconds = duel.microseconds;
      winner.fixedMicroseconds = duel.otherMicroseconds;
      break;
    }
  }
  winner.isFixed = winner.kernel == fixed.kernel;
  winner.program = record_.findings.at({key, winner.kernel}).program;
  record_.winners[key] = winner;
  save();
}

void KernelTrials::keep(const std::string& frame, const TunedFrame& tuned) {
  record_.frames[frame] = tuned;
  save();
}

}  // namespace xrds
