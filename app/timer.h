#pragma once

#include <chrono>

namespace xrds {

/// The time since it was made.
struct Timer {
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }
};

/// What an action takes.
template <class Action>
double secondsOf(Action&& action) {
  const Timer timer;
  action();
  return timer.seconds();
}

}  // namespace xrds
