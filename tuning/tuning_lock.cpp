#include "tuning/tuning_lock.h"

#include <cerrno>
#include <optional>

#include "xrds/error.h"

#ifdef _WIN32
#include <windows.h>
#else
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#endif

namespace xrds {
namespace {

// The open file, -1 where it cannot be opened or its file system has no locks, or nothing if another process holds it.
std::optional<intptr_t> locked(const std::filesystem::path& name) {
#ifdef _WIN32
  HANDLE const file = CreateFileW(name.c_str(), GENERIC_WRITE, 0, nullptr, OPEN_ALWAYS, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (file == INVALID_HANDLE_VALUE && GetLastError() == ERROR_SHARING_VIOLATION) return {};
  return reinterpret_cast<intptr_t>(file);
#else
  const int file = open(name.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0 || flock(file, LOCK_EX | LOCK_NB) == 0) return file;
  const bool isHeld = errno == EWOULDBLOCK;
  close(file);
  return isHeld ? std::optional<intptr_t>() : -1;
#endif
}

void closeLock(intptr_t file) {
#ifdef _WIN32
  CloseHandle(reinterpret_cast<HANDLE>(file));
#else
  close(static_cast<int>(file));
#endif
}

std::filesystem::path lockOf(std::filesystem::path file) { return file.replace_extension(".lock"); }

}  // namespace

// The lock ends with the process, however that ends; the empty file stays.
TuningLock::TuningLock(const std::filesystem::path& file) {
  if (file.empty()) return;
  const std::optional<intptr_t> opened = locked(lockOf(file));
  if (!opened) throw Error("Another process is tuning this device: wait until it is done.");
  file_ = *opened;
}

TuningLock::~TuningLock() {
  if (file_ >= 0) closeLock(file_);
}

bool isTuningLocked(const std::filesystem::path& file) {
  std::error_code failed;
  if (file.empty() || !std::filesystem::exists(lockOf(file), failed)) return false;
  const std::optional<intptr_t> opened = locked(lockOf(file));
  if (opened && *opened >= 0) closeLock(*opened);
  return !opened;
}

}  // namespace xrds
