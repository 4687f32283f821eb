#include "viewer/stage_times.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace xrds {
namespace {

constexpr std::array<const char*, 4> kStages{"image pipeline", "auxiliary branch", "low-resolution branch",
                                             "upsampling"};

size_t stageOf(std::string_view label) {
  const auto begins = [&](std::initializer_list<std::string_view> prefixes) {
    return std::any_of(prefixes.begin(), prefixes.end(), [&](auto prefix) { return label.starts_with(prefix); });
  };
  if (begins({"aux_", "deshuffle"})) return 1;
  if (begins({"lr_conv", "groups.", "fuse", "body_conv"})) return 2;
  if (begins({"up", "out"})) return 3;
  return 0;
}

}  // namespace

std::vector<StageTime> stageTimes(const std::vector<Upscaler::ProfileRow>& rows) {
  std::array<double, kStages.size()> sums{};
  for (const auto& row : rows) sums[stageOf(row.label)] += row.microseconds / 1000;
  std::vector<StageTime> times;
  for (size_t i = 0; i < sums.size(); ++i)
    if (sums[i] > 0) times.push_back({kStages[i], sums[i]});
  return times;
}

}  // namespace xrds
