#include "viewer/watch.h"

#include <gtest/gtest.h>

#include "image/test_files.h"
#include "tests/temporary_folder.h"

namespace xrds::test {
namespace {

using namespace std::chrono_literals;

TEST(FileWatch, TellsEachVersionOnceItIsStill) {
  const TemporaryFolder folder;
  const std::vector<std::filesystem::path> files{folder / "a", folder / "b"};
  FileWatch watch;
  auto now = std::chrono::steady_clock::time_point{} + 1h;
  EXPECT_FALSE(watch.changed(files, now));  // they are not there
  writeBytes(files[0], "1");
  EXPECT_FALSE(watch.changed(files, now += 1s));
  writeBytes(files[1], "1");
  EXPECT_FALSE(watch.changed(files, now += 1s));  // just seen
  EXPECT_FALSE(watch.changed(files, now += 10ms));
  EXPECT_TRUE(watch.changed(files, now += 200ms));
  EXPECT_FALSE(watch.changed(files, now += 1s));  // told already
  writeBytes(files[1], "12");
  EXPECT_FALSE(watch.changed(files, now += 50ms));
  writeBytes(files[1], "123");  // goes on being written
  EXPECT_FALSE(watch.changed(files, now += 50ms));
  EXPECT_FALSE(watch.changed(files, now += 50ms));
  EXPECT_TRUE(watch.changed(files, now += 50ms));
}

TEST(FileWatch, LooksAtOtherFilesAnew) {
  const TemporaryFolder folder;
  writeBytes(folder / "a", "1");
  writeBytes(folder / "b", "1");
  FileWatch watch;
  auto now = std::chrono::steady_clock::time_point{} + 1h;
  watch.changed({folder / "a"}, now);
  EXPECT_TRUE(watch.changed({folder / "a"}, now += 1s));
  EXPECT_FALSE(watch.changed({folder / "b"}, now += 1s));
  EXPECT_TRUE(watch.changed({folder / "b"}, now += 1s));
}

}  // namespace
}  // namespace xrds::test
