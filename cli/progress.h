#pragma once

#include "app/timer.h"
#include "xrds/error.h"
#include "xrds/preparation.h"

namespace xrds {

/// Installs handlers for SIGINT, SIGTERM and SIGHUP, unless that is ignored, that only set a flag: a running command
/// then cancels and cleans up. A file that outgrows the process's limit fails to be written, and no signal ends the
/// process.
void catchInterrupts();
bool interrupted();

/// Throws Failure with ExitCode::interrupted once the process was interrupted; called between the steps of a command.
void stopIfInterrupted();

/// Returns what the action returns. Where an interrupt cancelled it, throws what stopIfInterrupted() throws.
template <class Action>
auto untilInterrupted(Action&& action) {
  try {
    return action();
  } catch (const Cancelled&) {
    stopIfInterrupted();
    throw;
  }
}

/// While one lives, an interrupt ends the process at once, whatever a driver is busy with: for work that leaves nothing
/// behind. Not while a file is being written.
class EndsAtOnce {
 public:
  EndsAtOnce();
  ~EndsAtOnce();
  EndsAtOnce(const EndsAtOnce&) = delete;
  EndsAtOnce& operator=(const EndsAtOnce&) = delete;
};

/// How messages of progress appear: a line that is written over on a terminal, lines otherwise.
enum class ProgressStyle { none, lines, bar };
ProgressStyle progressStyle(bool quiet);

/// Says which programs a device is making, and how many of how many: on a terminal while it does, otherwise a line once
/// it has taken half a second and at tenths from then on, two seconds apart; nothing if quiet.
class PreparationLine {
 public:
  explicit PreparationLine(bool quiet);
  /// Returns false once the process was interrupted.
  bool update(const Preparation& preparation);

 private:
  ProgressStyle style_;
  Preparation::Phase phase_{};
  int lastTenth_ = -1;
  double nextLine_ = 0.5;  // seconds after the start
  Timer timer_;
};

/// Shows the share done: a bar with the time left on a terminal, a line every ten percent otherwise, nothing if quiet.
class ProgressBar {
 public:
  explicit ProgressBar(bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Returns false once the process was interrupted.
  bool update(double share);

 private:
  ProgressStyle style_;
  int lastTenth_ = 0;
  Timer timer_;
};

}  // namespace xrds
