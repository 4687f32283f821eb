// Windows that are left out while the viewer runs, and the map of them.
#include "tests/cli/frames.h"
#include "tests/viewer/viewer_display.h"

namespace xrds::test {
namespace {

TEST_F(ViewerDisplay, SwitchesSkippingAndShowsTheMap) {
  writeHalfEvenFrame(folder / "lr.exr", folder / "aux.exr", 20);
  const Ended ended =
      run("key P\nkey W\nwait\nprint\nkey K\nwait\nprint\nsave safe.exr\nkey 0\nwait\nscreenshot skip_map.png\n"
          "key K\nwait\nprint\nkey K\nkey 1\nwait\nprint\nsave full.exr\nwait\n",
          smallDisplay({"lr.exr", "aux.exr"}));
  const std::vector<double> interpolated = valuesOf(ended.output, "interpolated");
  ASSERT_EQ(interpolated.size(), 2u) << "off: the picture stays on the device\n" << ended.output;
  EXPECT_GT(interpolated[0], 0.4);
  EXPECT_GE(interpolated[1], interpolated[0]);
  EXPECT_TRUE(has(ended.output, "pictures=4 "));
  expectLikeStored(folder / "skip_map.png");
  const Ended compared =
      runXrds({"compare", (folder / "safe.exr").string(), (folder / "full.exr").string(), "--min-psnr", "50"});
  EXPECT_EQ(compared.exitCode, 0) << compared.output << compared.error;
}

// The pace of a run that was computed as a whole may lead to a network prepared anew, which has nothing to keep: that
// of the first pictures, then no more.
TEST_F(ViewerDisplay, KeepsWhatDidNotChangeInWatchedFiles) {
  writeHalfEvenFrame(folder / "first.exr", folder / "aux.exr", 70);
  writeHalfEvenFrame(folder / "second.exr", folder / "aux.exr", 70, 63);
  const Ended ended =
      run("copy first.exr lr.exr\nawait 1\nwait\nprint\ncopy second.exr lr.exr\nawait 2\nwait\n"
          "copy first.exr lr.exr\nawait 3\nwait\ncopy second.exr lr.exr\nawait 4\nwait\nprint\n"
          "copy first.exr lr.exr\nawait 5\nwait\nprint\n",
          smallDisplay({"--watch", "lr.exr", "aux.exr", "--skip", "safe"}));
  const std::vector<double> kept = valuesOf(ended.output, "kept");
  ASSERT_EQ(kept.size(), 3u) << ended.output;
  EXPECT_EQ(kept[0], 0);
  EXPECT_GT(kept[2], 0.3);
}

TEST_F(ViewerDisplay, TellsWhichModelsCannotSkip) {
  writeHalfEvenFrame(folder / "lr.exr", folder / "aux.exr", 20);
  const Ended ended =
      run("wait\nprint\n", {"lr.exr", "--model", goldenModel("s1_none_noaux"), "--skip", "safe", "--size", "400x340"});
  EXPECT_TRUE(has(ended.output, "pictures=1 ")) << ended.output;
  EXPECT_TRUE(has(ended.output, "not-skipped=\"")) << ended.output;
}

}  // namespace
}  // namespace xrds::test
