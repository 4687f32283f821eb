// Frames that do not fit the memory of the device.
#include "tests/viewer/viewer_display.h"

namespace xrds::test {
namespace {

TEST_F(ViewerDisplay, ShowsFramesInTilesAsTheyAreFinished) {
  const std::vector<std::string> memory{"--memory", "8M"};
  std::vector<std::string> arguments = smallDisplay({kColour, kAuxiliary});
  arguments.insert(arguments.end(), memory.begin(), memory.end());
  const Ended ended = run("wait\nprint\nsave saved.exr\nwait\n", arguments);
  const std::vector<double> tiles = valuesOf(ended.output, "tiles");
  ASSERT_EQ(tiles.size(), 1u) << ended.output;
  EXPECT_GT(tiles[0], 1);
  EXPECT_EQ(valuesOf(ended.output, "partial").size(), 1u) << ended.output;
  std::vector<std::string> upscale{"upscale", kColour,        kAuxiliary, "-o", (folder / "out.exr").string(),
                                   "--model", "xrds-x4-nano", "--quiet"};
  upscale.insert(upscale.end(), memory.begin(), memory.end());
  EXPECT_EQ(runXrds(upscale).exitCode, 0);
  const Ended compared =
      runXrds({"compare", (folder / "saved.exr").string(), (folder / "out.exr").string(), "--min-psnr", "80"});
  EXPECT_EQ(compared.exitCode, 0) << compared.output << compared.error;
}

// What makes it useless stops it: of two runs one is finished.
TEST_F(ViewerDisplay, CancelsARunInTiles) {
  std::vector<std::string> arguments = smallDisplay({kColour, kAuxiliary});
  arguments.insert(arguments.end(), {"--memory", "8M"});
  const Ended ended = run("!key C\nwait\nprint\n", arguments);
  EXPECT_TRUE(has(ended.output, "pictures=1 ")) << ended.output;
  EXPECT_TRUE(has(ended.output, "precision=fp16")) << ended.output;
}

}  // namespace
}  // namespace xrds::test
