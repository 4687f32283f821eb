// The samples work as README.md shows them.
#include <nlohmann/json.hpp>

#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

const std::string kSamples = XRDS_SAMPLE_FOLDER;

std::vector<std::string> upscale(const std::string& scene, const TemporaryFolder& out) {
  return {"upscale",
          kSamples + "/" + scene + "_lr64.exr",
          kSamples + "/" + scene + "_aux16.exr",
          "-o",
          (out / "out.exr").string(),
          "--json",
          (out / "run.json").string(),
          "--quiet"};
}

TEST(CliSamples, GiveNoWarning) {
  const TemporaryFolder out;
  for (const char* scene : {"interior", "outdoor", "glossy", "studio"}) {
    auto arguments = upscale(scene, out);
    arguments.insert(arguments.end(), {"--model", goldenModel("s4_guided")});
    const Ended ended = runXrds(arguments);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_EQ(ended.error, "") << scene;
  }
}

TEST(CliSamples, StudioShowsWhatSkippingSaves) {
  const TemporaryFolder out;
  auto arguments = upscale("studio", out);
  arguments.insert(arguments.end(), {"--model", "xrds-x4-nano", "--skip", "safe"});
  const Ended ended = runXrds(arguments);
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  const auto skip = nlohmann::json::parse(readBytes(out / "run.json"))["skip"];
  EXPECT_GT(skip["share"], 0.6) << skip;
  EXPECT_LT(skip["work"], 0.6) << skip;
}

TEST(CliSamples, AreScenesOfTheBenchmarks) {
  const TemporaryFolder out;
  const std::string json = (out / "samples.json").string();
  const Ended ended =
      runXrds({"bench", "quality", kSamples, "--model", goldenModel("s4_guided"), "--json", json, "--quiet"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(ended.output, "");
  const auto report = nlohmann::json::parse(readBytes(json));
  EXPECT_TRUE(report["skipped"].empty());
  for (const char* scene : {"glossy", "interior", "outdoor", "studio"})
    EXPECT_GT(report["methods"][2]["scenes"][scene]["psnr"], 15) << scene;
}

// Halos that do not fit the smallest scene are left out, unless they were asked for.
TEST(CliSamples, AreCutIntoTiles) {
  const std::vector<std::string> tiles{"bench", "tiles", kSamples, "--model", goldenModel("s4_guided")};
  const Ended fitting = runXrds(tiles);
  ASSERT_EQ(fitting.exitCode, 0) << fitting.error;
  EXPECT_NE(fitting.output.find("| 32 |"), std::string::npos) << fitting.output;
  EXPECT_EQ(fitting.output.find("| 48 |"), std::string::npos) << fitting.output;
  auto asked = tiles;
  asked.insert(asked.end(), {"--halo", "48"});
  const Ended refused = runXrds(asked);
  EXPECT_EQ(refused.exitCode, 2) << refused.error;
  EXPECT_NE(refused.error.find("is too small for 2 x 1 tiles with a halo of 48"), std::string::npos) << refused.error;
}

}  // namespace
}  // namespace xrds::test
