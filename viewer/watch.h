#pragma once

#include <chrono>
#include <filesystem>
#include <vector>

namespace xrds {

/// Notices when files have been written again and no longer change.
class FileWatch {
 public:
  /// True once each time that the files were changed since the last true and have been still for a while: writers that
  /// pause longer leave files that cannot be read yet, and are looked at again when they go on. Files that are not
  /// there count as changing.
  bool changed(const std::vector<std::filesystem::path>& files, std::chrono::steady_clock::time_point now);
  /// Everything is new again.
  void forget() { *this = FileWatch(); }

 private:
  struct State {
    std::filesystem::file_time_type time{};
    std::uintmax_t byteSize = 0;
    bool operator==(const State&) const = default;
  };
  std::vector<std::filesystem::path> files_;
  std::vector<State> seen_, taken_;
  std::chrono::steady_clock::time_point since_{};
};

}  // namespace xrds
