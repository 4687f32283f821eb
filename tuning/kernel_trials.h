#pragma once

#include "tuning/trial.h"
#include "tuning/tuned.h"
#include "tuning/tuner.h"
#include "tuning/tuning_lock.h"

namespace xrds {

/// An operator shape, and the form in whose graph it is tried.
struct FormShape {
  std::string shape;
  const Form* form = nullptr;
  const Node& node() const { return form->nodeOf(shape); }
};

/// The trials of one tuning, with the record of what is known. Each finding is written to the disk as soon as it is
/// made, and what is about to run before it does: if it ends the process, the next one knows.
class KernelTrials {
 public:
  /// `families`: that the device can run. Reads the record. Throws Error if another process tunes the device.
  KernelTrials(Gpu& gpu, uint32_t size, std::vector<KernelFamily> families, const TuningOptions& options);

  const TuningRecord& record() const { return record_; }
  size_t measured() const { return measured_; }
  /// Whether the record is on the disk; else this process alone knows it.
  bool isKept() const { return isKept_; }

  /// The kernels of a shape of which nothing is known; with `shapes` those of a family in other shapes, too, if the
  /// family is near the best.
  std::vector<KernelCandidate> open(const FormShape& shape, bool shapes) const;
  /// Compiles the open kernels of all shapes, program by program, many at once.
  void compile(const std::vector<FormShape>& todo, bool shapes, double share, double endShare);
  /// Proves and times the open kernels of a shape.
  void tryOpen(const FormShape& shape, bool shapes, double share, std::optional<Trial>& trial);
  /// Lets the best kernel of a shape compete with the fixed choice, in turns, which it must beat by more than noise.
  void decide(const FormShape& shape, std::optional<Trial>& trial);
  bool isDecided(const std::string& shape) const { return record_.winners.contains(keyOf(shape)); }

  /// The least time of a kernel of the shape that is right, of a family or of any; 0: there is none.
  double best(const std::string& shape, std::optional<KernelFamily> family = {}) const;

  void keep(const std::string& frame, const TunedFrame& tuned);
  /// Throws Cancelled if the caller says so.
  void tell(double share, const std::string& text) const;

 private:
  TrialKey keyOf(const std::string& shape) const { return {size_, shape}; }
  // Those that are right, with their times, the fastest first.
  std::vector<std::pair<double, KernelChoice>> fastest(const std::string& shape) const;
  void save() { isKept_ = file_.write(record_); }
  // Of an operator, the kernel that runs where nothing is tuned.
  KernelCandidate fixedOf(const FormShape& shape) const;
  void marked(const std::string& program, bool isFixed, const std::function<void()>& work);
  Finding tried(Trial& trial, const KernelCandidate& candidate, bool isFixed, double best);

  Gpu& gpu_;
  uint32_t size_;
  std::vector<KernelFamily> families_;
  const TuningOptions& options_;
  TuningFile file_;
  TuningLock lock_;
  TuningRecord record_;
  size_t measured_ = 0;
  bool isKept_ = false;
};

}  // namespace xrds
