// Sequences and live views that are stable over time, and flicker as a picture.
#include <array>

#include "image/metrics/metrics.h"
#include "image/srgb.h"
#include "tests/cli/moving_sequence.h"
#include "tests/viewer/viewer_display.h"

namespace xrds::test {
namespace {

std::vector<std::string> shown(const MovingSequence& sequence, std::vector<std::string> more = {}) {
  more.insert(more.begin(),
              {(sequence.folder / "colour.####.exr").string(), (sequence.folder / "aux.####.exr").string(), "--size",
               "400x340", "--model", "xrds-x4-nano"});
  return more;
}

TEST_F(ViewerDisplay, PlaysASequenceWithAndWithoutItsNeighbours) {
  const MovingSequence sequence;
  const Ended ended =
      run("key PageDown\nkey PageDown\nwait\nprint\nsave alone.exr\nkey A\nwait\nprint\nsave merged.exr\nwait\n"
          "screenshot merged.png\nkey Home\nkey Space\nawait 8\nkey Space\nwait\nprint\n",
          shown(sequence, {"--fps", "100"}));
  EXPECT_EQ(valuesOf(ended.output, "merged"), (std::vector<double>{6, 6})) << ended.output;  // all, of three or less
  for (const std::string name : {"alone", "merged"}) {
    std::vector<std::string> arguments{"upscale",
                                       (sequence.folder / "colour.####.exr").string(),
                                       (sequence.folder / "aux.####.exr").string(),
                                       "-o",
                                       (folder / "out.####.exr").string(),
                                       "--frames",
                                       "3",
                                       "--model",
                                       "xrds-x4-nano",
                                       "--quiet"};
    if (name == "merged") arguments.emplace_back("--temporal");
    ASSERT_EQ(runXrds(arguments).exitCode, 0);
    const Ended compared = runXrds(
        {"compare", (folder / (name + ".exr")).string(), (folder / "out.0003.exr").string(), "--min-psnr", "80"});
    EXPECT_EQ(compared.exitCode, 0) << name << compared.output;
  }
}

TEST_F(ViewerDisplay, TakesTheRadiusAndTheMotionThatAreNamed) {
  const MovingSequence sequence({.layer = "speed"});
  const Ended ended = run("key PageDown\nkey PageDown\nkey A\nwait\nprint\nsave merged.exr\nwait\n",
                          shown(sequence, {"--temporal-radius", "1", "--motion", "speed"}));
  EXPECT_EQ(valuesOf(ended.output, "merged"), std::vector<double>{3}) << ended.output;
  const std::string merged = (folder / "out.####.exr").string();
  std::vector<std::string> arguments{"upscale",
                                     (sequence.folder / "colour.####.exr").string(),
                                     (sequence.folder / "aux.####.exr").string(),
                                     "-o",
                                     merged,
                                     "--frames",
                                     "3",
                                     "--model",
                                     "xrds-x4-nano",
                                     "--quiet",
                                     "--temporal",
                                     "--temporal-radius",
                                     "1",
                                     "--motion",
                                     "speed"};
  ASSERT_EQ(runXrds(arguments).exitCode, 0);
  const Ended compared =
      runXrds({"compare", (folder / "merged.exr").string(), (folder / "out.0003.exr").string(), "--min-psnr", "80"});
  EXPECT_EQ(compared.exitCode, 0) << compared.output;
}

TEST_F(ViewerDisplay, PlaysASequenceUntilItsPicturesAreMade) {
  const MovingSequence sequence;
  std::vector<std::string> arguments =
      shown(sequence, {"--frames", "3", "--screenshot", (folder / "third.png").string()});
  arguments.insert(arguments.begin(), "view");
  const Ended ended = runXrds(
      arguments, {.environment = {{"DISPLAY", desktop.name()}, {"XDG_CONFIG_HOME", (folder / "config").string()}}});
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(readPng(folder / "third.png").width, 400);
}

TEST_F(ViewerDisplay, TellsThatASequenceHasNoMotion) {
  const MovingSequence sequence({.layer = "speed"});
  const Ended ended = run("wait\nkey A\nwait\nprint\nkey A\nwait\nprint\n", shown(sequence));
  EXPECT_EQ(occurrences(ended.output, "error=\""), 1U) << ended.output;
  EXPECT_TRUE(has(ended.output, "has no motion layer 'Vector'")) << ended.output;
}

// Of two pictures the deviation is half of their difference; merged frames have less of it.
TEST_F(ViewerDisplay, ShowsFlickerAsAPicture) {
  const MovingSequence sequence;
  const std::string looks = "move 150 130\nwait\nprint\n";
  const Ended ended = run("key P\nkey W\nwait\n" + looks + "key PageDown\nwait\n" + looks +
                              "key PageUp\nkey Y\nkey PageDown\n" + looks + "screenshot flicker.png\nwait\n",
                          shown(sequence));
  const auto results = printedOf(ended.output, "xrds"), deviations = printedOf(ended.output, "flicker");
  ASSERT_EQ(results.size(), 2U) << ended.output;
  ASSERT_EQ(deviations.size(), 1U) << ended.output;
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    const double change = srgbFromLinear(results[1][c]) - srgbFromLinear(results[0][c]);
    sum += change * change / 3;
  }
  EXPECT_NEAR(deviations[0][0], std::sqrt(sum) / 2, 0.01 * std::sqrt(sum));
  const Image shot = readPng(folder / "flicker.png");
  EXPECT_GT(meanDifference(cropped(shot, 72, 74, 100, 100), Image(100, 100, 3)), 10) << "a heat map";
}

TEST_F(ViewerDisplay, MergedFramesFlickerLess) {
  const MovingSequence sequence({.step = 0});
  const auto flicker = [&](const std::vector<std::string>& more) {
    std::string script = "key P\nkey W\nkey Y\n";
    for (int frame = 2; frame <= kFrames; ++frame) script += "wait\nkey PageDown\n";
    for (int x = 80; x < 320; x += 40) script += "move " + std::to_string(x) + " 150\nwait\nprint\n";
    double sum = 0;
    const Ended ended = run(script, shown(sequence, more));
    for (const auto& pixel : printedOf(ended.output, "flicker")) sum += pixel[0];
    EXPECT_GT(sum, 0) << ended.output;
    return sum;
  };
  EXPECT_LT(flicker({"--temporal", "on"}), 0.8 * flicker({}));
}

// A view that has moved has what it showed before: less noise, of as many samples.
TEST_F(ViewerDisplay, MovedLiveViewsKeepWhatTheyHaveShown) {
  const auto moved = [&](const std::string& name, const std::string& samples, std::vector<std::string> more) {
    more.insert(more.end(), {"--live", "room", "--live-size", "64x64", "--samples", samples, "--size", "320x260",
                             "--model", "xrds-x4-nano"});
    const Ended ended = run("wait\nkey Shift+Left\nwait\nprint\nsave " + name + "\nwait\n", more);
    return valuesOf(ended.output, "merged").size();
  };
  EXPECT_EQ(moved("alone.exr", "4", {"--temporal", "off"}), 0U);
  EXPECT_EQ(moved("merged.exr", "4", {}), 1U);
  EXPECT_EQ(moved("reference.exr", "72", {}), 0U) << "it has faded out";
  const auto psnr = [&](const std::string& name) {
    const Image image = readColour((folder / name).string()),
                reference = readColour((folder / "reference.exr").string());
    return measure(image, reference).psnr;
  };
  EXPECT_GT(psnr("merged.exr"), psnr("alone.exr") + 0.5);
}

}  // namespace
}  // namespace xrds::test
