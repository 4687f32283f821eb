#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "xrds/preparation.h"

namespace xrds {

/// The programs that threads make, counted, while the thread that waits for them tells the caller.
class PreparationReport {
 public:
  PreparationReport(const PreparationProgress& progress, Preparation::Phase phase, size_t total)
      : progress_(progress), phase_(phase), total_(total) {}

  /// From any thread: one more is made; whether the caller has cancelled.
  void advance() { ++done_; }
  bool cancelled() const { return cancelled_; }

  /// Runs the work on as many threads, all the same, and reports from this one until they have returned; without a
  /// caller to tell, this thread is one of them. The work must not throw, and returns early once cancelled().
  /// Throws Cancelled if the caller said so.
  void await(size_t threadCount, const std::function<void(size_t thread)>& work);

 private:
  void tell();

  const PreparationProgress& progress_;
  Preparation::Phase phase_;
  size_t total_ = 0;
  std::atomic<size_t> done_ = 0;
  std::atomic<bool> cancelled_ = false;
};

}  // namespace xrds
