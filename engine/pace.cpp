#include "engine/pace.h"

#include <algorithm>

namespace xrds {
namespace {

constexpr double kLeastSeconds = 0.002;           // of a run that tells something
constexpr double kLeastWork = uint64_t{1} << 24;  // of a submission: a third of a millisecond at 100 GFLOP/s
constexpr double kMostWork = uint64_t{1} << 40;   // far more than any device does in that time

}  // namespace

uint64_t workOfSubmission(const Pace& pace, uint64_t most) {
  if (pace.slowest <= 0) return std::min(kUnknownWork, most);
  const double work = std::clamp(pace.slowest * kSubmissionSeconds, kLeastWork, kMostWork);
  return std::min(static_cast<uint64_t>(work), most);
}

Pace measured(const Pace& before, double work, double seconds, double slowest) {
  if (seconds < kLeastSeconds || slowest <= 0) return before;
  return {work / seconds, slowest};
}

}  // namespace xrds
