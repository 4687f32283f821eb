#include "image/pending_file.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "tests/temporary_folder.h"
#include "xrds/error.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;

TEST(PendingFile, WhatKilledProcessesLeftIsRemovedWhenItIsOld) {
  const TemporaryFolder folder;
  const PendingFile fresh(folder / "fresh.exr"), old(folder / "old.exr");
  for (const fs::path& file :
       {fresh.temporaryPath(), old.temporaryPath(), folder / "mine.part", folder / ".xrds-1.exr"})
    std::ofstream(file) << "half";
  for (const fs::path& file : {old.temporaryPath(), folder / "mine.part", folder / ".xrds-1.exr"})
    fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(2));
  removeAbandonedFiles(fresh.temporaryPath().parent_path());
  EXPECT_TRUE(fs::exists(fresh.temporaryPath()));
  EXPECT_FALSE(fs::exists(old.temporaryPath()));
  EXPECT_EQ(folder.fileCount(), 3U);
  removeAbandonedFiles(folder / "none");  // does nothing
}

TEST(PendingFile, NamesThatNoFileCanHaveAreRefusedAtOnce) {
  const TemporaryFolder folder;
  EXPECT_THROW(PendingFile(folder / (std::string(300, 'a') + ".exr")), Error);
#ifdef _WIN32
  for (const char* name : {"a<b.exr", "a?.exr", "a.exr:b.exr"}) EXPECT_THROW(PendingFile(folder / name), Error);
#endif
}

}  // namespace
}  // namespace xrds::test
