// Frames of which a part needs no network, through the command.
#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

struct HalfEvenFrame : SmallFrame {
  explicit HalfEvenFrame(int edge) { writeHalfEvenFrame(color, aux, edge); }
  Image upscaled(const std::vector<std::string>& more, const std::string& words = "") const {
    const Ended ended = runXrds(arguments(more));
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_NE(ended.output.find(words), std::string::npos) << ended.output;
    return readColour(out);
  }
};

TEST(CliSkip, InterpolatesTheBackgroundAndShowsWhere) {
  const HalfEvenFrame frame(20);
  const std::string map = (frame.folder / "map.png").string();
  const Image result = frame.upscaled({"--skip", "safe", "--skip-map", map}, " % of the windows skipped");
  for (int y = 0; y < 280; ++y) EXPECT_NEAR(result.at(359, y, 1), 0.4F, 1e-5F);
  EXPECT_TRUE(readBytes(map).starts_with("\x89PNG"));
  const Image tiled = frame.upscaled({"--skip", "0.01", "--memory", "4M"}, " % of the windows skipped");
  for (int y = 0; y < 280; ++y) EXPECT_NEAR(tiled.at(359, y, 1), 0.4F, 1e-5F);
}

TEST(CliSkip, ChangesNothingWhereEveryWindowIsNeeded) {
  const HalfEvenFrame frame(90);
  EXPECT_EQ(frame.upscaled({"--skip", "safe"}, ", 0 % of the windows skipped"), frame.upscaled({}));
}

TEST(CliSkip, RefusesWhatCannotHold) {
  const SmallFrame frame;
  const std::string none = goldenModel("s2_none_linear_albedo");
  expectFailure(runXrds(frame.arguments({"--skip", "safe", "--wrap"})), 2, "exclude each other", frame.folder, 2);
  EXPECT_EQ(runXrds(frame.arguments({"--skip", "some"})).exitCode, 2);
  EXPECT_EQ(runXrds(frame.arguments({"--skip", "-1"})).exitCode, 2);
  writeParts(frame.aux, {{boxOf(20, 16), boxOf(20, 16), {albedoLayer("albedo", 20)}}});
  expectFailure(runXrds(frame.arguments({"--skip", "0.01"}, none)), 4, "--skip is refused", frame.folder, 2);
}

}  // namespace
}  // namespace xrds::test
