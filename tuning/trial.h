#pragma once

#include <functional>
#include <string>
#include <vector>

#include "checks/placed_operator.h"

namespace xrds {

/// An operator of a network in its own size, on which kernels are tried: first whether they are right, then how fast.
class Trial {
 public:
  /// `graph` holds one node. Throws Error if the device has no room for it.
  Trial(Gpu& gpu, Graph graph);

  struct Proof {
    std::string why{};        // it is wrong: a sentence; empty: it is right
    double microseconds = 0;  // of the run that proved it
  };
  /// Some rows of what the kernel makes are compared with double precision, all of it with what the first kernel that
  /// was right made. Throws Error if the device fails.
  Proof prove(const KernelChoice& kernel);

  /// Microseconds of one launch of the kernel, the median of a few runs; of one that takes some times `best`, the
  /// fastest so far, of fewer, or of its proof alone. `best` 0: there is none.
  double time(const KernelChoice& kernel, double best, double proof);

  struct Duel {
    double microseconds = 0, otherMicroseconds = 0;  // medians
    bool isWon = false;  // in most rounds, by the medians, and by more than kMargin of the fastest and the median ratio
  };
  static constexpr double kMargin = 0.03;
  /// Both in turns.
  Duel duel(const KernelChoice& kernel, const KernelChoice& other);

 private:
  double run(Recording& recording) const;

  Gpu& gpu_;
  DataType stored_;
  PlacedOperator placed_;
  std::vector<PlacedOperator::Expected> expected_;
  std::vector<float> firstRight_;
};

}  // namespace xrds
