#include "tuning/trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <numeric>

#include "engine/parallel.h"
#include "shaders/common/tolerance.h"
#include "tuning/timing.h"

namespace xrds {
namespace {

constexpr double kLeastMicroseconds = 1500;  // of a timed run: shorter ones are noise
constexpr uint32_t kMostCopies = 64;
constexpr int kRuns = 5, kRounds = 7, kRoundsToWin = 5;

uint32_t copiesFor(double microseconds) {
  return std::clamp(static_cast<uint32_t>(std::ceil(kLeastMicroseconds / std::max(microseconds, 1.0))), 1u,
                    kMostCopies);
}

// The first rows, some in the middle and the last ones: one each, or as many as a pixel becomes.
std::vector<RowRange> sampledRows(const Node& node) {
  const RowRange all = outputRows(node);
  const uint32_t step = std::visit([](const auto& op) { return shuffleFactor(op); }, node.op);
  const bool hasRows = std::visit(
      [](const auto& op) {
        return requires { op.rows; };
      },
      node.op);
  const uint32_t count = (all.end - all.begin) / step;
  if (!hasRows || count <= 3) return {all};
  std::vector<RowRange> rows;
  for (const uint32_t row : {0u, count / 2, count - 1})
    rows.push_back({all.begin + row * step, all.begin + (row + 1) * step});
  return rows;
}

// Of the difference, over that of the others; where both hold NaN, neither writes.
double relativeRms(std::span<const float> numbers, std::span<const float> others) {
  std::mutex access;
  double difference = 0, power = 0;
  inParallel(numbers.size(), 1 << 16, [&](uint64_t i, uint64_t end) {
    double squares = 0, otherSquares = 0;
    for (; i < end; ++i) {
      if (std::isnan(numbers[i]) && std::isnan(others[i])) continue;
      squares += (double{numbers[i]} - others[i]) * (double{numbers[i]} - others[i]);
      otherSquares += double{others[i]} * others[i];
    }
    const std::lock_guard lock(access);
    difference += squares;
    power += otherSquares;
  });
  return std::sqrt(difference / power);
}

Recording repeated(Gpu& gpu, const PlacedOperator::Launch& launch, uint32_t copies) {
  std::vector<PlacedDispatch> dispatches;
  for (uint32_t i = 0; i < copies; ++i)
    dispatches.insert(dispatches.end(), launch.dispatches.begin(), launch.dispatches.end());
  return {gpu, dispatches, {.timestamps = true}};
}

}  // namespace

Trial::Trial(Gpu& gpu, Graph graph)
    : gpu_(gpu),
      stored_(outputOf(graph.nodes.front()).type),
      placed_(gpu, graph),
      expected_(placed_.expected(sampledRows(graph.nodes.front()))) {}

// By the device's clock where it has one that counts: that of a CPU starts before the work does.
double Trial::run(Recording& recording) const {
  const auto start = std::chrono::steady_clock::now();
  recording.run();
  const double wall = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  const auto times = recording.gpuMicroseconds();
  const double device = std::accumulate(times.begin(), times.end(), 0.0);
  return gpu_.description().kind == DeviceKind::cpu || device <= 0 ? wall : device;
}

Trial::Proof Trial::prove(const KernelChoice& kernel) {
  const PlacedOperator::Launch launch = placed_.launchOf(kernel);
  placed_.clearOutput();
  Recording once = repeated(gpu_, launch, 1);
  const double microseconds = run(once);
  std::vector<float> made = placed_.output();
  for (const auto& expected : expected_)
    if (const OperatorError error = placed_.errorOf(made, expected); !error.withinTolerance)
      return {error.finite ? "its error is " + std::to_string(error.rms) + " of the result"
                           : "it gives no finite numbers"};
  if (firstRight_.empty()) {
    firstRight_ = std::move(made);
    return {"", microseconds};
  }
  const Tolerance tolerance = toleranceOf(stored_);
  const double rms = relativeRms(made, firstRight_);
  if (rms <= 2 * tolerance.rms) return {"", microseconds};
  return {std::isnan(rms) ? "it leaves results out" : "its results differ by " + std::to_string(rms) + " from others'"};
}

double Trial::time(const KernelChoice& kernel, double best, double proof) {
  if (best > 0 && proof > 4 * best) return proof;
  const PlacedOperator::Launch launch = placed_.launchOf(kernel);
  Recording once = repeated(gpu_, launch, 1);
  double first = run(once);  // wakes the device up
  if (best <= 0 || first <= 3 * best) first = std::min(first, run(once));
  if (best > 0 && first > 3 * best) return first;
  const uint32_t copies = copiesFor(first);
  Recording several = repeated(gpu_, launch, copies);
  std::vector<double> times;
  for (int i = 0; i < kRuns; ++i) times.push_back(run(several) / copies);
  return median(times);
}

Trial::Duel Trial::duel(const KernelChoice& kernel, const KernelChoice& other) {
  const PlacedOperator::Launch launch = placed_.launchOf(kernel), otherLaunch = placed_.launchOf(other);
  // Each as often as makes a run that is no noise, however far apart they are.
  const auto copiesOf = [&](const PlacedOperator::Launch& each) {
    Recording probe = repeated(gpu_, each, 1);
    const double first = run(probe);
    return copiesFor(std::min(first, run(probe)));
  };
  const uint32_t copies = copiesOf(launch), otherCopies = copiesOf(otherLaunch);
  Recording mine = repeated(gpu_, launch, copies), others = repeated(gpu_, otherLaunch, otherCopies);
  std::vector<double> times, otherTimes, ratios;
  int won = 0;
  for (int round = 0; round < kRounds; ++round) {
    double time = 0, otherTime = 0;
    for (const bool first : {round % 2 == 0, round % 2 != 0})
      (first ? time : otherTime) = first ? run(mine) / copies : run(others) / otherCopies;
    times.push_back(time);
    otherTimes.push_back(otherTime);
    ratios.push_back(time / otherTime);
    won += time < otherTime;
  }
  const auto least = [](const std::vector<double>& all) { return *std::min_element(all.begin(), all.end()); };
  Duel duel{median(times), median(otherTimes)};
  duel.isWon = won >= kRoundsToWin && duel.microseconds < duel.otherMicroseconds && median(ratios) < 1 - kMargin &&
               least(times) < (1 - kMargin) * least(otherTimes);
  return duel;
}

}  // namespace xrds
