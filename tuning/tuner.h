#pragma once

#include <functional>

#include "engine/dispatch.h"
#include "tuning/tuned.h"

namespace xrds {

/// How far a tuning is, and what it does.
struct TuningStep {
  double share = 0;
  std::string text;  // "conv3x3 32 > 32"
};

/// What a tuning is asked for.
struct TuningOptions {
  Precision precision = Precision::fp32;
  std::string label{};  // TunedFrame::label
  bool anew = false;    // forgets what is known of the device, struck-off kernels, too
  /// Called before each kernel; returning false ends the tuning with Cancelled. What is known by then is kept.
  std::function<bool(const TuningStep&)> progress{};
  /// Called before a kernel runs for the first time, for tests: what it throws is taken for the device's failure.
  std::function<void(const Dispatch&)> beforeRun{};
};

/// Proves and times the kernels that may make each operator shape of the model in frames of that size, and whole frames
/// at last, and keeps what it finds: a second call, also after one that was cancelled or killed, goes on where that
/// stopped. Where that cannot be written this process alone knows it. The device must run the family that is its own,
/// not one that was asked for. Throws DeviceLost if a kernel loses the device, which is then struck off: open the
/// device anew and go on. Throws Error if another process tunes the device, or if not even the fixed choice runs.
TuningResult tune(Gpu& gpu, const NetworkModel& model, FrameShape frame, const TuningOptions& options);

}  // namespace xrds
