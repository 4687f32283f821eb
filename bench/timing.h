#pragma once

#include <chrono>
#include <numeric>
#include <span>

#include "engine/recording.h"

namespace xrds::bench {

/// A recording whose runs are timed: the sum of its dispatches' device times, or the wall clock on a device without
/// timestamps.
class TimedRecording {
 public:
  TimedRecording(Gpu& gpu, std::span<const PlacedDispatch> dispatches)
      : recording_(gpu, dispatches, {.timestamps = true}) {}

  /// Seconds of this run.
  double run() {
    const auto start = std::chrono::steady_clock::now();
    recording_.run();
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    const auto times = recording_.gpuMicroseconds();
    return times.empty() ? wall.count() : 1e-6 * std::accumulate(times.begin(), times.end(), 0.0);
  }

 private:
  Recording recording_;
};

}  // namespace xrds::bench
