#include "viewer/display/placement.h"

#include <gtest/gtest.h>

#include "image/test_files.h"
#include "tests/temporary_folder.h"

namespace xrds::test {
namespace {

TEST(Placement, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  const auto file = folder / "deep/viewer.json";
  writePlacement(file, {.width = 900, .height = 700, .x = -20, .y = 30, .maximized = true});
  const Placement placement = readPlacement(file);
  EXPECT_EQ(placement.width, 900);
  EXPECT_EQ(placement.height, 700);
  EXPECT_EQ(placement.x, -20);
  EXPECT_EQ(placement.y, 30);
  EXPECT_TRUE(placement.maximized);
}

TEST(Placement, SurvivesAnyFile) {
  const TemporaryFolder folder;
  for (const char* text :
       {"", "[]", "{", "{\"width\": \"a\", \"maximized\": 3}", "{\"width\": 1e99, \"height\": -5}"}) {
    writeBytes(folder / "v.json", text);
    const Placement placement = readPlacement(folder / "v.json");
    EXPECT_EQ(placement.width, 1280) << text;
    EXPECT_EQ(placement.height, 800) << text;
    EXPECT_FALSE(placement.maximized) << text;
  }
  EXPECT_EQ(readPlacement(folder / "none.json").width, 1280);
  writePlacement("/proc/none/viewer.json", {});
}

}  // namespace
}  // namespace xrds::test
