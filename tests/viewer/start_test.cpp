// Starts that can show nothing end with their exit code; later failures are told on the display.
#include "tests/viewer/viewer_display.h"

namespace xrds::test {
namespace {

/// One sentence with a name of what there is.
void expectRefused(const Ended& ended, int exitCode, const std::string& named) {
  EXPECT_EQ(ended.exitCode, exitCode) << ended.error;
  EXPECT_TRUE(has(ended.error, named)) << ended.error;
  EXPECT_EQ(occurrences(ended.error, "\n"), 1u) << ended.error;
}

TEST_F(ViewerDisplay, EndsWhereNothingCanBeShown) {
  const auto view = [&](const std::vector<std::string>& arguments) {
    return runViewer(desktop, folder, "wait\n", arguments);
  };
  writeBytes(folder / "bad.obj", "nothing");
  writeBytes(folder / "bad.safetensors", "nothing");
  expectRefused(view({"--live", "x"}), 3, "There is no scene 'x'");
  expectRefused(view({"--live", "bad.obj"}), 3, "bad.obj");
  expectRefused(view({kColour, kAuxiliary, "--model", "x"}), 4, "There is no model 'x'");
  expectRefused(view({"--live", "room", "--model", "bad.safetensors"}), 4, "bad.safetensors");
  expectRefused(view({kColour, kAuxiliary, "--model", "xrds-x2-compact"}), 4, "upscales by 2");
  std::filesystem::copy_file(kColour, folder / "cut.exr");
  std::filesystem::resize_file(folder / "cut.exr", 20000);
  EXPECT_EQ(view({"cut.exr"}).exitCode, 3);
}

TEST(HeadlessFailure, HasTheSameExitCodes) {
  const StartOptions nowhere{.environment = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}};
  EXPECT_EQ(runXrds({"view", "--headless", "--live", "x", "--frames", "1"}, nowhere).exitCode, 3);
  EXPECT_EQ(runXrds({"view", "--headless", "--live", "room", "--frames", "1", "--model", "x"}, nowhere).exitCode, 4);
}

TEST_F(ViewerDisplay, StaysWhereTheUserIsAtIt) {
  const Ended ended = run("drop none.exr\nwait\nprint\nscreenshot failed.png\nwait\n", smallDisplay({}));
  EXPECT_TRUE(has(ended.output, "error=\"")) << ended.output;
  const Image shot = readPng(folder / "failed.png");
  double reddest = 0;
  for (size_t p = 0; p < shot.pixels.size() / 3; ++p)
    reddest = std::max(reddest, static_cast<double>(shot.pixels[3 * p] - shot.pixels[3 * p + 2]));
  EXPECT_GT(reddest, 100) << "the failure is told";
}

}  // namespace
}  // namespace xrds::test
