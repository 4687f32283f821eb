#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "xrds/xrds.hpp"

namespace xrds {

/// A part of the way from file to picture.
struct StageTime {
  std::string name;
  double milliseconds = 0;
  bool isPart = false;  // of the nearest stage above it that is none
};

inline constexpr const char* kNetworkStage = "network";
inline constexpr const char* kTotalStage = "total";

/// Times steps that follow each other without a gap, so that they add up.
class StageClock {
 public:
  using Clock = std::chrono::steady_clock;

  /// Forgets what was timed; the next step begins now.
  void begin(Clock::time_point now = Clock::now());
  /// A step ends now. Steps of the same name are summed.
  void end(const char* step, Clock::time_point now = Clock::now());
  const std::vector<StageTime>& steps() const { return steps_; }

 private:
  std::vector<StageTime> steps_;
  Clock::time_point since_ = Clock::now();
};

/// The dispatches of a run summed by the part of the network that they belong to, in the order of the network; empty
/// if the device has no timestamps.
std::vector<StageTime> networkParts(const std::vector<Upscaler::ProfileRow>& rows);

/// All that a picture took: the steps, those of the network with its parts and what passed between its kernels, and
/// their total.
std::vector<StageTime> stageTimes(const std::vector<StageTime>& steps, const std::vector<Upscaler::ProfileRow>& rows);

}  // namespace xrds
