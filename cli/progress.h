#pragma once

#include <chrono>

namespace xrds {

/// Installs handlers for SIGINT and SIGTERM that only set a flag: a running command then cancels and cleans up.
void catchInterrupts();
bool interrupted();

/// Throws Failure with ExitCode::interrupted once the process was interrupted; called between the steps of a command.
void stopIfInterrupted();

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
  enum class Style { none, lines, bar };
  Style style_;
  int lastTenth_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace xrds
