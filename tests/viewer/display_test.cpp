// The viewer's display, driven by scripts, under the validation layers: every run must end without a message.
#include <gtest/gtest.h>

#include "tests/viewer/viewer_display.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;

TEST_F(ViewerDisplay, ShowsTheColoursThatUpscaleWrites) {
  run("key P\nkey W\nwait\nscreenshot shot.png\nsave saved.exr\nwait\n", smallDisplay({kColour, kAuxiliary}));
  const Ended upscaled = runXrds({"upscale", kColour, kAuxiliary, "-o", (folder / "out.exr").string(), "--preview",
                                  (folder / "preview.png").string(), "--model", "xrds-x4-nano", "--quiet"});
  ASSERT_EQ(upscaled.exitCode, 0) << upscaled.error;
  const Image shot = cropped(readPng(folder / "shot.png"), 40, 50, 320, 240);  // in the middle of the display
  EXPECT_LT(meanDifference(shot, readPng(folder / "preview.png")), 0.1);
  const Ended compared =
      runXrds({"compare", (folder / "saved.exr").string(), (folder / "out.exr").string(), "--min-psnr", "80"});
  EXPECT_EQ(compared.exitCode, 0) << compared.output << compared.error;
}

TEST_F(ViewerDisplay, LooksAsItDid) {
  run("key P\nwait\nscreenshot wipe.png\n"
      "key Shift+6\nkey 7\nwait\nscreenshot reference_error.png\n"
      "key Shift+8\nkey 9\nmove 200 170\nscroll 4\nwait\nscreenshot albedo_normal_zoomed.png\n"
      "key F\nkey Shift+3\nkey 4\nkey E\nkey T\nwait\nscreenshot bases_brighter_filmic.png\n"
      "move 200 100\npress\nmove 90 100\nrelease\nmove 399 339\nwait\nscreenshot divider_dragged.png\n"
      "key H\nwait\nscreenshot help.png\nwait\n",
      smallDisplay({kColour, kAuxiliary, kReference}));
  for (const char* name :
       {"wipe", "reference_error", "albedo_normal_zoomed", "bases_brighter_filmic", "divider_dragged", "help"})
    expectLikeStored(folder / (std::string(name) + ".png"));
}

TEST_F(ViewerDisplay, SurvivesNewSizesAndLostSwapchains) {
  // No event tells that the desktop has minimized a window: some never do.
  const Ended ended =
      run("wait\nsize 500 400\nwait\nscreenshot larger.png\nwait\nlose swapchain\nwait\nlose surface\nwait\nprint\n"
          "size 330 250\nwait\nkey P\nwait\nscreenshot smaller.png\nminimize\nsleep 0.1\nrestore\nwait\nprint\n",
          smallDisplay({kColour, kAuxiliary}));
  EXPECT_EQ(readPng(folder / "larger.png").width, 500);
  EXPECT_EQ(readPng(folder / "smaller.png").width, 330);
  EXPECT_TRUE(has(ended.output, "window=500x400 swapchains=4")) << ended.output;
  EXPECT_TRUE(has(ended.output, "window=330x250 swapchains=5")) << ended.output;
}

TEST_F(ViewerDisplay, SwitchesModelAndPrecisionAndTellsPixels) {
  const Ended ended =
      run("wait\nprint\nkey C\nwait\nprint\nkey Shift+M\nwait\nprint\nmove 60 170\nwait\nprint\n"
          "drop " +
              kAuxiliary + " " + kColour + "\nwait\nprint\ndrop none.exr\nwait\nprint\n",
          smallDisplay({kColour, kAuxiliary, kReference}));
  EXPECT_TRUE(has(ended.output, "pictures=1 files=outdoor_lr64.exr model=xrds-x4-nano precision=fp32")) << ended.output;
  EXPECT_TRUE(has(ended.output, "compared=1"));
  EXPECT_TRUE(has(ended.output, "pictures=2 files=outdoor_lr64.exr model=xrds-x4-nano precision=fp16")) << ended.output;
  EXPECT_TRUE(has(ended.output, "pictures=3 files=outdoor_lr64.exr model=xrds-x4-mini precision=fp16")) << ended.output;
  EXPECT_TRUE(has(ended.output, " input@")) << ended.output;
  EXPECT_TRUE(has(ended.output, " reference@")) << ended.output;
  EXPECT_TRUE(has(ended.output, "pictures=4")) << ended.output;
  EXPECT_TRUE(has(ended.output, "none.exr")) << ended.output;
}

// The viewer takes a file that nobody has written to for a while: only time shows that it leaves half of one alone.
TEST_F(ViewerDisplay, WaitsForHalfWrittenFiles) {
  const Ended ended = run("copy " + kColour + " lr.exr\nsleep 0.4\nprint\npart 20000 " + kAuxiliary +
                              " aux.exr\nsleep 0.4\nprint\ncopy " + kAuxiliary +
                              " aux.exr\nawait 1\nwait\nprint\ncopy " + kColour + " lr.exr\nawait 2\nwait\nprint\n",
                          smallDisplay({"--watch", "lr.exr", "aux.exr"}));
  EXPECT_TRUE(has(ended.output, "pictures=0")) << ended.output;
  EXPECT_TRUE(has(ended.output, "waiting=\"Waiting for 'aux.exr', which is not there yet.\"")) << ended.output;
  EXPECT_TRUE(has(ended.output, "waiting=\"Cannot read 'aux.exr'")) << ended.output;
  EXPECT_TRUE(has(ended.output, "pictures=1 files=lr.exr")) << ended.output;
  EXPECT_TRUE(has(ended.output, "pictures=2 files=lr.exr")) << ended.output;
}

TEST_F(ViewerDisplay, WatchesAFolder) {
  fs::create_directory(folder / "renders");
  const Ended ended =
      run("copy " + kColour + " renders/lr.exr\ncopy " + kAuxiliary + " renders/aux.exr\nawait 1\nwait\nprint\ncopy " +
              kColour + " renders/second.exr\nawait 2\nwait\nprint\n",
          smallDisplay({"renders"}));
  EXPECT_TRUE(has(ended.output, "files=lr.exr")) << ended.output;
  EXPECT_TRUE(has(ended.output, "files=second.exr")) << ended.output;
}

TEST_F(ViewerDisplay, PlaysScrubsAndLoopsASequence) {
  for (const char* number : {"0009", "0010", "0011"}) {
    copy(kColour, std::string("shot.") + number + ".exr");
    copy(kAuxiliary, std::string("aux.") + number + ".exr");
  }
  const Ended ended =
      run("wait\nprint\nkey End\nwait\nprint\nkey PageUp\nwait\nprint\nkey Home\nkey Space\nawait 8\nkey "
          "Space\nwait\nprint\n",
          smallDisplay({"shot.####.exr", "aux.####.exr", "--fps", "100"}));
  EXPECT_TRUE(has(ended.output, "files=shot.0009.exr model=xrds-x4-nano precision=fp32 frame=0")) << ended.output;
  EXPECT_TRUE(has(ended.output, "files=shot.0011.exr model=xrds-x4-nano precision=fp32 frame=2")) << ended.output;
  EXPECT_TRUE(has(ended.output, "files=shot.0010.exr model=xrds-x4-nano precision=fp32 frame=1")) << ended.output;
  EXPECT_EQ(occurrences(ended.output, "pictures="), 4u);
}

TEST_F(ViewerDisplay, FollowsTheScaleOfTheDisplay) {
  const std::vector<std::string> files = smallDisplay({kColour, kAuxiliary});
  run("wait\nprint\n", {});
  desktop.scale(2);
  const Ended first = run("wait\nprint\nkey H\nwait\nscreenshot large.png\nwait\n", files);
  EXPECT_TRUE(has(first.output, "window=800x680")) << first.output;
  expectLikeStored(folder / "large.png");
  // It is remembered as it would be on an ordinary display, and does not grow from start to start.
  run("size 864 642\nwait\n", {});
  EXPECT_TRUE(has(run("wait\nprint\n", {}).output, "window=864x642"));
  EXPECT_TRUE(has(run("wait\nprint\n", {}).output, "window=864x642"));
  desktop.scale(1);
  EXPECT_TRUE(has(run("wait\nprint\n", {}).output, "window=432x321"));
}

TEST_F(ViewerDisplay, RemembersItsSize) {
  run("size 432 321\nwait\n", {});
  const Ended ended = run("wait\nprint\n", {});
  EXPECT_TRUE(has(ended.output, "window=432x321")) << ended.output;
}

TEST_F(ViewerDisplay, LeavesAfterPicturesAndKeepsAScreenshot) {
  const StartOptions options{
      .environment = {{"DISPLAY", desktop.name()}, {"XDG_CONFIG_HOME", (folder / "config").string()}},
      .folder = folder / ""};
  const Ended ended = runXrds({"view", kColour, kAuxiliary, "--model", "xrds-x4-nano", "--frames", "1", "--screenshot",
                               "shot.png", "--statistics"},
                              options);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(has(ended.output, "pictures 1 ")) << ended.output;
  EXPECT_EQ(readPng(folder / "shot.png").width, 1280);
}

TEST(ViewerFailure, WithoutADisplayOneSentence) {
  const Ended ended = runXrds({"view", kColour}, {.environment = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}});
  EXPECT_EQ(ended.exitCode, 5);
  EXPECT_TRUE(has(ended.error, "No window can be opened")) << ended.error;
  EXPECT_EQ(occurrences(ended.error, "\n"), 1u) << ended.error;
}

TEST_F(ViewerDisplay, RefusesWhatItCannotOpen) {
  const auto view = [&](const std::vector<std::string>& arguments) {
    return runViewer(desktop, folder, "wait\n", arguments);
  };
  EXPECT_EQ(view({"none.exr"}).exitCode, 3);
  EXPECT_EQ(view({"none.####.exr"}).exitCode, 3);
  EXPECT_EQ(view({kColour, "--device", "bogus"}).exitCode, 5);
  EXPECT_EQ(view({kColour, "--size", "big"}).exitCode, 2);
  EXPECT_EQ(runViewer(desktop, folder, "dance\n").exitCode, 2);
}

}  // namespace
}  // namespace xrds::test
