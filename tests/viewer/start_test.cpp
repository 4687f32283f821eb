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

TEST(ViewerUsage, NamesTheSlipAndWhatIsNearest) {
  expectRefused(runXrds({"view", "--modle", "x"}), 2,
                "xrds view has no option '--modle'; the nearest is '--model'; see xrds view --help.");
  expectRefused(runXrds({"view", "--model"}), 2, "see xrds view --help.");
  expectRefused(runXrds({"view", "--colour", "x", "--headless"}), 2, "--headless needs --live");  // as --color
}

TEST(ViewerUsage, TellsTheLimitsOfASize) {
  for (const char* size : {"4x4", " 64x64", "64x+64"})
    expectRefused(runXrds({"view", "--headless", "--live", "room", "--frames", "1", "--live-size", size}), 2,
                  "--live-size takes WIDTHxHEIGHT, such as 1920x1080, of 8 to 16384 pixels each, found '" +
                      std::string(size) + "'.");
}

TEST(ViewerUsage, RefusesAScreenshotThatWouldNotBeWritten) {
  expectRefused(runXrds({"view", kColour, "--screenshot", "x.png"}), 2, "--screenshot requires --frames");
  expectRefused(runXrds({"view", kColour, "--screenshot", "x.png", "--frames", "0"}), 2, "--frames");
  const std::vector<std::string> live{"view", "--headless", "--live", "room", "--frames", "1"};
  const auto refuses = [&](std::vector<std::string> more, const std::string& why) {
    more.insert(more.begin(), live.begin(), live.end());
    expectRefused(runXrds(more), 2, why);
  };
  for (const char* option : {"--screenshot", "--script"}) refuses({option, "x.png"}, "excludes --headless");
  refuses({"--watch"}, "--watch excludes --live");
  refuses({"x.exr"}, "FILES excludes --live");
  for (const std::string option : {"--reference", "--color", "--albedo", "--glossy", "--aux-colour", "--motion"})
    refuses({option, "x"}, "--live excludes " + option);
  for (const std::string option : {"--fps", "--temporal-radius"}) refuses({option, "9"}, "--live excludes " + option);
  refuses({"--denoise-first", "--clean-guides"}, "--live excludes --clean-guides");
}

TEST_F(ViewerDisplay, TellsOfAScreenshotThatCameToNothing) {
  expectRefused(runViewer(desktop, folder, "wait\n", smallDisplay({"--frames", "9", "--screenshot", "x.png"})), 6,
                "The screenshot 'x.png' was not written");
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

TEST_F(ViewerDisplay, NamesWhatNoFileCanHave) {
  std::filesystem::create_symlink("circle.exr", folder / "circle.exr");
  const std::string tooLong(300, 'a');
  expectRefused(runViewer(desktop, folder, "wait\n", {"circle.exr"}), 3, "Too many levels of symbolic links");
  expectRefused(runViewer(desktop, folder, "wait\n", {tooLong}), 3, "File name too long");
  expectRefused(runViewer(desktop, folder, "wait\n", {"--live", tooLong}), 3, "There is no scene");
}

TEST_F(ViewerDisplay, ScriptsThatCannotGoOnAreAMistakeOfTheirs) {
  const auto played = [&](const std::string& script) { return runViewer(desktop, folder, script, smallDisplay({})); };
  expectRefused(played("key Foo\n"), 2, "Line 1 of the script: There is no key 'Foo'");
  expectRefused(played("wait\ncopy none.exr a.exr\n"), 2, "Line 2 of the script: Cannot copy 'none.exr' to 'a.exr'");
  expectRefused(played("part 3 none.exr a.exr\n"), 2, "Cannot copy 'none.exr'");
  expectRefused(runXrds({"view", "--script", (folder / "").string()}, {.environment = {{"DISPLAY", desktop.name()}}}),
                2, "cannot be read");
}

TEST_F(ViewerDisplay, TellsWhatBecameOfFilesToWrite) {
  copy(kColour, "cut.exr");
  std::filesystem::resize_file(folder / "cut.exr", 20000);
  const std::string script =
      "key Ctrl+S\nwait\nprint\nkey S\nwait\nprint\ndrop cut.exr\nwait\nsave cut_out.exr\nwait\nprint\n";
  const Ended ended = run(script, smallDisplay({kColour, kAuxiliary}));
  EXPECT_TRUE(has(ended.output, "notice=\"Saved xrds-0001.exr\"")) << ended.output;
  EXPECT_TRUE(has(ended.output, "notice=\"Saved xrds-0001.png\"")) << ended.output;
  EXPECT_TRUE(has(ended.output, "notice=\"There is no picture to save yet.\"")) << ended.output;
}

TEST_F(ViewerDisplay, GoesOnWhereAScreenshotCannotBeWritten) {
  std::filesystem::create_symlink("xrds-0001.png", folder / "xrds-0001.png");
  const Ended ended = run("key S\nwait\nprint\n", smallDisplay({kColour, kAuxiliary}));
  EXPECT_TRUE(has(ended.output, "error=\"Cannot write 'xrds-0001.png'")) << ended.output;
  EXPECT_EQ(runViewer(desktop, folder, "screenshot none/a.png\nwait\n", smallDisplay({})).exitCode, 6);
}

}  // namespace
}  // namespace xrds::test
