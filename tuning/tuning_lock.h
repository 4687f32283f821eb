#pragma once

#include <cstdint>
#include <filesystem>

namespace xrds {

/// Keeps other processes from tuning the same device, whose trials would spoil each other's times. Of no effect where
/// nothing is kept, or on a file system without locks.
class TuningLock {
 public:
  /// `file`: of the record. Throws Error if another process holds it.
  explicit TuningLock(const std::filesystem::path& file);
  ~TuningLock();
  TuningLock(const TuningLock&) = delete;
  TuningLock& operator=(const TuningLock&) = delete;

 private:
  intptr_t file_ = -1;
};

/// Whether somebody holds the lock. `file`: of the record.
bool isTuningLocked(const std::filesystem::path& file);

}  // namespace xrds
