#include "tuning/tuning_lock.h"

#include <gtest/gtest.h>

#include "tests/temporary_folder.h"
#include "xrds/error.h"

#ifndef _WIN32
#include <dlfcn.h>
#include <sys/file.h>

#include <atomic>
#include <cerrno>

namespace {
std::atomic<int> failure;  // of all locks, as of a file system that has none; 0: the file system's own
}

// In place of the C library's, in all of this program.
extern "C" int flock(int file, int operation) {
  if (failure == 0) return reinterpret_cast<decltype(&flock)>(dlsym(RTLD_NEXT, "flock"))(file, operation);
  errno = failure;
  return -1;
}
#endif

namespace xrds {
namespace {

namespace fs = std::filesystem;

class TuningLockFile : public testing::Test {
 protected:
  const test::TemporaryFolder folder_;
};

TEST_F(TuningLockFile, IsHeldOnceAtATime) {
  const fs::path file = folder_ / "tuning.bin";
  {
    const TuningLock first(file);
    EXPECT_THROW(TuningLock{file}, Error);
    EXPECT_NO_THROW(TuningLock{folder_ / "other.bin"});
  }
  EXPECT_NO_THROW(TuningLock{file});
}

TEST_F(TuningLockFile, IsSeenByThoseWhoDoNotWantIt) {
  const fs::path file = folder_ / "tuning.bin";
  EXPECT_FALSE(isTuningLocked({}));
  EXPECT_FALSE(isTuningLocked(file));
  EXPECT_TRUE(fs::is_empty(folder_.path()));
  {
    const TuningLock held(file);
    EXPECT_TRUE(isTuningLocked(file));
    EXPECT_FALSE(isTuningLocked(folder_ / "other.bin"));
  }
  EXPECT_FALSE(isTuningLocked(file));
  EXPECT_NO_THROW(TuningLock{file});
}

TEST_F(TuningLockFile, GoesWithoutWhereItCannotBe) {
  EXPECT_NO_THROW(TuningLock{fs::path()});
  EXPECT_NO_THROW(TuningLock{folder_ / "none" / "tuning.bin"});
#ifndef _WIN32
  for (const int none : {ENOLCK, ENOTSUP}) {
    failure = none;
    EXPECT_NO_THROW(TuningLock{folder_ / "tuning.bin"}) << none;
  }
  failure = 0;
#endif
}

}  // namespace
}  // namespace xrds
