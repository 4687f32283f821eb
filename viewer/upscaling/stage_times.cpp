#include "viewer/upscaling/stage_times.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace xrds {
namespace {

constexpr std::array<const char*, 5> kStages{"image pipeline", "auxiliary branch", "low-resolution branch",
                                             "upsampling", "denoisers"};

size_t stageOf(std::string_view label) {
  const auto begins = [&](std::initializer_list<std::string_view> prefixes) {
    return std::any_of(prefixes.begin(), prefixes.end(), [&](auto prefix) { return label.starts_with(prefix); });
  };
  if (begins({"aux_", "deshuffle"})) return 1;
  if (begins({"lr_conv", "groups.", "fuse", "body_conv"})) return 2;
  if (begins({"up", "out"})) return 3;
  if (begins({"enc_conv", "dec_conv"})) return 4;
  return 0;
}

}  // namespace

void StageClock::begin(Clock::time_point now) {
  steps_.clear();
  since_ = now;
}

void StageClock::end(const char* step, Clock::time_point now) {
  const double passed = std::chrono::duration<double, std::milli>(now - std::exchange(since_, now)).count();
  const auto known = std::find_if(steps_.begin(), steps_.end(), [&](const StageTime& s) { return s.name == step; });
  if (known == steps_.end())
    steps_.push_back({step, passed});
  else
    known->milliseconds += passed;
}

std::vector<StageTime> networkParts(const std::vector<Upscaler::ProfileRow>& rows) {
  std::array<double, kStages.size()> sums{};
  for (const auto& row : rows) sums[stageOf(row.label)] += row.microseconds / 1000;
  std::vector<StageTime> times;
  for (size_t i = 0; i < sums.size(); ++i)
    if (sums[i] > 0) times.push_back({kStages[i], sums[i], true});
  return times;
}

std::vector<StageTime> stageTimes(const std::vector<StageTime>& steps, const std::vector<Upscaler::ProfileRow>& rows) {
  std::vector<StageTime> times;
  double total = 0;
  for (const StageTime& step : steps) {
    times.push_back(step);
    total += step.milliseconds;
    if (step.name != kNetworkStage) continue;
    double rest = step.milliseconds;
    for (StageTime& part : networkParts(rows)) {
      rest -= part.milliseconds;
      times.push_back(std::move(part));
    }
    // Clocks of host and device differ a little.
    if (times.back().isPart && rest > 0) times.push_back({"between kernels", rest, true});
  }
  times.push_back({kTotalStage, total});
  return times;
}

}  // namespace xrds
