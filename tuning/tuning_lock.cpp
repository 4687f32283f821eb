#include "tuning/tuning_lock.h"

#include "xrds/error.h"

#ifndef _WIN32
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#endif

namespace xrds {

#ifdef _WIN32
TuningLock::TuningLock(const std::filesystem::path&) {}
TuningLock::~TuningLock() = default;
#else
// The lock ends with the process, however that ends; the empty file stays.
TuningLock::TuningLock(const std::filesystem::path& file) {
  if (file.empty()) return;
  auto name = file;
  name.replace_extension(".lock");
  descriptor_ = open(name.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (descriptor_ < 0 || flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  close(descriptor_);
  throw Error("Another process is tuning this device: wait until it is done.");
}

TuningLock::~TuningLock() {
  if (descriptor_ >= 0) close(descriptor_);
}
#endif

}  // namespace xrds
