#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/exit_code.h"
#include "app/timer.h"
#include "cli/progress.h"
#include "cli/sequence_plan.h"
#include "sequence/assembly_line.h"

namespace xrds {

/// What became of the frames of a sequence: shown as it goes, listed at the end, and kept in a log. One thread at a
/// time.
class SequenceReport {
 public:
  SequenceReport(const UpscaleOptions& options, const SequencePlan& plan, const LineThreads& threads);

  /// Takes one outcome in and shows the progress. Returns false once the sequence must end: it was interrupted, or
  /// kFailuresInARow frames failed one after the other by the device or the output.
  bool add(const Outcome& outcome);
  static constexpr int kFailuresInARow = 3;

  /// Warnings about a frame: each is printed at its first appearance, and at the end which other frames had one that
  /// differs in digits at most, as in the name of a file.
  void warn(int frame, const std::vector<std::string>& warnings);

  /// Writes the log, where one is asked for; a warning tells if it cannot be written.
  void writeLog() const;
  void printAlike() const;

  /// Writes the log and prints what was made. Throws Failure if frames failed, or the process was interrupted.
  void finish();

 private:
  struct Row {
    Outcome outcome;
    std::string message;
    ExitCode code = ExitCode::ok;
  };
  struct Alike {
    std::string first;
    std::set<int> frames;
  };
  std::string progressText() const;
  std::string slowestStage() const;
  void show(const Row& row);
  /// What is printed of a failure: of one with a list of layers only the first of those that differ in digits at most.
  std::string failureText(int number, const std::string& message);

  const UpscaleOptions& options_;
  const SequencePlan& plan_;
  const LineThreads threads_;
  const ProgressStyle style_;
  std::map<size_t, Row> rows_;  // by the frame's index
  std::vector<int> failed_;
  std::map<std::string, Alike> warnings_;  // by their text without digits
  std::map<std::string, int> failures_;    // the first frame of each failure, by the same
  std::array<double, 3> seconds_{};
  size_t done_ = 0, skipped_ = 0;
  int failuresInARow_ = 0;
  std::optional<Failure> ended_;  // why it must end
  Timer whole_;
  double logged_ = 0;  // seconds of the last log
};

}  // namespace xrds
