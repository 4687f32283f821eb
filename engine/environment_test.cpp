#include "engine/environment.h"

#include <gtest/gtest.h>

#include "engine/cache_folder.h"
#include "tests/environment_variable.h"
#include "tests/temporary_folder.h"

namespace xrds {
namespace {

// As the home of somebody whose name has them.
TEST(Environment, NamesFoldersOfAnyLetters) {
  const test::TemporaryFolder folder;
  const std::filesystem::path home = folder.path() / u8"J\u00fcrgen \u03a9 \u65e5\u672c";
  const test::EnvironmentVariable variable("XDG_CACHE_HOME", home);
  EXPECT_EQ(environmentPath("XDG_CACHE_HOME"), home);
  EXPECT_EQ(defaultCacheFolder(), home / "xrds");
  EXPECT_TRUE(canWriteFiles(defaultCacheFolder()));
  EXPECT_TRUE(std::filesystem::exists(home / "xrds"));
}

TEST(Environment, HasNoFolderOfARelativePath) {
  const test::EnvironmentVariable variable("XDG_CACHE_HOME", "relative");
  EXPECT_TRUE(userFolder("XDG_CACHE_HOME").empty());
  EXPECT_TRUE(environmentPath("XRDS_NOT_SET").empty());
}

}  // namespace
}  // namespace xrds
