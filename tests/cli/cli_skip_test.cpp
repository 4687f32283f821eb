// Frames of which a part needs no network, through the command.
#include <nlohmann/json.hpp>

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

TEST(CliSkip, BenchTimesPairsOfRunsAndTellsTheLargestChange) {
  const TemporaryFolder folder, out;
  const Layer colour = colourLayer("", 360);
  for (const auto& [name, edge] : {std::pair{"even", 20}, {"noise", 90}}) {
    writeHalfEvenFrame(folder / (std::string(name) + "_lr64.exr"), folder / (std::string(name) + "_aux16.exr"), edge);
    writeParts(folder / (std::string(name) + "_gt.exr"), {{boxOf(360, 280), boxOf(360, 280), {colour}}});
  }
  const std::string json = (out / "skip.json").string(), table = (out / "skip.md").string();
  std::vector<std::string> bench{
      "bench", "skip", (folder / "").string(), "--model", goldenModel("s4_guided"), "--runs", "2", "--json"};
  auto measured = bench;
  measured.insert(measured.end(), {json, "--markdown", table});
  const Ended ended = runXrds(measured);
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  // The bound is one of trained models: random weights break it.
  EXPECT_NE(ended.output.find("the bound does not hold"), std::string::npos) << ended.output;
  EXPECT_NE(ended.output.find("Where nothing is skipped: 2 pairs"), std::string::npos) << ended.output;
  EXPECT_NE(readBytes(table).find("| scene | skipped | work |"), std::string::npos);

  const auto report = nlohmann::json::parse(readBytes(json));
  EXPECT_EQ(report["devices"].size(), 1u);
  EXPECT_EQ(report["runs"], 2);
  EXPECT_NEAR(report["bound"], 0.005, 1e-6);
  EXPECT_GT(report["largestChange"], report["bound"]);
  EXPECT_EQ(report["largestChange"], report["scenes"][0]["largestChange"]["skipped"]);
  EXPECT_EQ(report["cost"]["pairs"], 2);
  ASSERT_EQ(report["scenes"].size(), 2u);
  const auto &even = report["scenes"][0], &noise = report["scenes"][1];
  EXPECT_EQ(even["name"], "even");
  EXPECT_GT(even["skipped"], 0.2);
  EXPECT_LT(even["work"], 1);
  EXPECT_EQ(even["secondsOff"].size(), 2u);
  EXPECT_EQ(noise["skipped"], 0);
  EXPECT_EQ(noise["work"], 1);
  EXPECT_EQ(noise["psnr"], noise["psnrOff"]);

  expectFailure(runXrds({"bench", "skip", (folder / "").string(), "--skip", "off"}), 2, "nothing to compare", folder,
                6);
  bench.push_back("skip.txt");
  expectFailure(runXrds(bench), 2, "--json takes a name that ends in .json", folder, 6);
  expectFailure(runXrds({"bench", "skip", (folder / "").string(), "--markdown", "skip.txt"}), 2,
                "--markdown takes a name that ends in .md", folder, 6);
  expectFailure(runXrds({"bench", "skip", (folder / "").string(), "--samples", "0"}), 2, "--samples", folder, 6);
  expectFailure(runXrds({"bench", "skip", (folder / "").string(), "--model", goldenModel("s4_guided"), "--scale", "2"}),
                2, "has scale 4", folder, 6);
}

}  // namespace
}  // namespace xrds::test
