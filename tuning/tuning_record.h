#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "graph/kernel_table.h"

namespace xrds {

/// An operator as it was tried: operatorKey() in frames of about 2^size low-resolution pixels.
struct TrialKey {
  uint32_t size = 0;
  std::string shape;
  auto operator<=>(const TrialKey&) const = default;
};

/// A program as it was when something was found out about it: with another hash it is another one.
struct ProgramStamp {
  std::string name;
  uint64_t hash = 0;
  bool operator==(const ProgramStamp&) const = default;
};

/// What was found of one kernel of an operator.
struct Finding {
  ProgramStamp program{};
  bool right = false;
  double microseconds = 0;  // of one launch; 0: wrong
  std::string why{};        // it is wrong
};

/// The kernel that makes an operator fastest; it may be the fixed choice.
struct Winner {
  KernelChoice kernel{};
  ProgramStamp program{}, fixedProgram{};
  double microseconds = 0, fixedMicroseconds = 0;  // of one launch; of the fixed choice
  bool isFixed = false;
};

/// What came out for a model in frames of one size: the form of its graph, and whether a whole frame gained.
struct TunedFrame {
  bool taken = false;  // else the fixed choice is used
  std::optional<bool> normsInLinear{}, layersFused{};
  double seconds = 0, fixedSeconds = 0;  // of a frame
  double tuningSeconds = 0;
  int64_t date = 0;     // seconds since 1970
  std::string label{};  // for people: model, precision and size
};

/// Everything that tuning knows of a device with its driver: a plain value, and its file.
struct TuningRecord {
  std::map<std::pair<TrialKey, KernelChoice>, Finding> findings;
  std::map<TrialKey, Winner> winners;
  std::map<std::string, std::pair<uint64_t, std::string>> struckOff;  // programs: hash, why
  std::map<std::string, TunedFrame> frames;                           // by frameKey()
  std::optional<ProgramStamp> trying;                                 // being compiled or run while this is on disk
  bool isFixedTried = false;                                          // `trying` is of the fixed choice
  std::map<std::string, uint64_t> suspects;  // programs of the fixed choice that were tried when a process ended: hash

  /// What was being tried when a process ended is struck off; of the fixed choice, which every frame runs where nothing
  /// is tuned, when it happened a second time: a process that was killed says nothing of the kernel.
  void takeStock();
  /// Drops what is of programs that have changed since. `hashNow` gives a program's hash, 0 if there is none.
  void dropStale(const std::function<uint64_t(const std::string&)>& hashNow);
  bool isStruckOff(const ProgramStamp& program) const;
};

/// As text, a line each; fromText() of anything else gives an empty record.
std::string toText(const TuningRecord& record);
TuningRecord fromText(std::string_view text);

/// The record of a device, read from its cache folder and written back whole. A file that is missing, damaged or of
/// another device or driver is an empty record. What cannot be written, as where there is no folder, this process alone
/// knows.
class TuningFile {
 public:
  TuningFile(const std::filesystem::path& folder, std::string driverKey);
  TuningRecord read() const;
  /// Returns false if it cannot be written; read() gives it all the same.
  bool write(const TuningRecord& record) const;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::string driverKey_;
  std::filesystem::path path_;
};

}  // namespace xrds
