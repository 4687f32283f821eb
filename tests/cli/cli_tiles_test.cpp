// Frames that do not fit the memory they may use: tiles, through the command.
#include <nlohmann/json.hpp>

#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

/// A frame of 90 x 70 pixels and what goes with it, with noise, so that every pixel counts.
struct NoisyFrame : SmallFrame {
  NoisyFrame() {
    const auto noise = [](const std::string& name, const char* channels) {
      return Layer{name, channels, [](int x, int y, int c) {
                     return 0.1F + 0.9F * static_cast<float>((x * 7919 + y * 104729 + c * 31 + x * y) % 256) / 255;
                   }};
    };
    writeParts(color, {{boxOf(90, 70), boxOf(90, 70), {noise("", "RGB")}}});
    writeParts(aux, {{boxOf(360, 280), boxOf(360, 280), {noise("albedo", "RGB"), noise("normal", "XYZ")}}});
  }
  Ended upscale(const std::vector<std::string>& more) const { return runXrds(arguments(more)); }
  Image upscaled(const std::vector<std::string>& more, const std::string& words) const {
    const Ended ended = upscale(more);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_NE(ended.output.find(words), std::string::npos) << ended.output;
    return readColour(out);
  }
};

TEST(CliTiles, ExactOnesMakeThePictureOfTheWholeFrame) {
  const NoisyFrame frame;
  const Image whole = frame.upscaled({}, "360 x 280, model");
  EXPECT_EQ(frame.upscaled({"--memory", "4M", "--tiles", "exact"}, " tiles, model"), whole);
  const Image bounded = frame.upscaled({"--memory", "4M"}, " tiles, model");
  EXPECT_EQ(bounded.width, whole.width);
  EXPECT_NE(frame.upscaled({"--wrap"}, "360 x 280"), whole);
}

TEST(CliTiles, SaysWhatTheSmallestNeed) {
  const NoisyFrame frame;
  expectFailure(frame.upscale({"--memory", "200K"}), 5, "0 MB are allowed", frame.folder, 2);
  EXPECT_EQ(frame.upscale({"--memory", "many"}).exitCode, 2);
  EXPECT_EQ(frame.upscale({"--memory", "-1M"}).exitCode, 2);
  EXPECT_EQ(frame.upscale({"--tiles", "some"}).exitCode, 2);
}

TEST(CliTiles, ControlCEndsARunInTilesAndLeavesNothing) {
  const NoisyFrame frame;
  std::vector<std::string> arguments = frame.arguments({"--memory", "4M", "--tiles", "exact"});
  const Ended ended = runOnTerminal(arguments, "[###", "\x03");
  EXPECT_EQ(ended.exitCode, 130) << ended.output;
  EXPECT_NE(ended.output.find("Interrupted"), std::string::npos) << ended.output;
  EXPECT_EQ(frame.folder.fileCount(), 2u);
}

TEST(CliTiles, InfoTellsTheTilesThatFit) {
  const Ended ended = runXrds({"info", "xrds-x4-nano", "--size", "8192x8192", "--memory", "512M"});
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_NE(ended.output.find("In 512M of device memory:\n  fp32: "), std::string::npos) << ended.output;
  EXPECT_NE(ended.output.find(" tiles of at most "), std::string::npos) << ended.output;
  EXPECT_NE(runXrds({"info", "xrds-x4-nano", "--memory", "1GiB"}).output.find("in one piece"), std::string::npos);
  EXPECT_EQ(runXrds({"info", "xrds-x4-nano", "--memory", "1K"}).exitCode, 2);
}

TEST(CliTiles, BenchMeasuresTheErrorOfEachHalo) {
  const TemporaryFolder folder, maps, out;
  const NoisyFrame frame;
  std::filesystem::copy_file(frame.color, folder / "s_lr64.exr");
  std::filesystem::copy_file(frame.aux, folder / "s_aux16.exr");
  const Layer colour = colourLayer("", 360);
  writeParts(folder / "s_gt.exr", {{boxOf(360, 280), boxOf(360, 280), {colour}}});
  const std::string json = (out / "tiles.json").string();
  std::vector<std::string> bench{"bench", "tiles", (folder / "").string(), "--model", goldenModel("s4_guided"),
                                 "--json"};
  auto measured = bench;
  measured.insert(measured.end(), {json, "--halo", "0,32", "--heat-map", (maps / "").string()});
  const Ended ended = runXrds(measured);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(ended.output.find("| 0 | 0.00e+00"), std::string::npos) << ended.output;
  EXPECT_NE(ended.output.find("| 32 | 0.00e+00 | 0.00e+00 | +0.0000 | +0.0000 | 0.00 |"), std::string::npos)
      << ended.output;
  EXPECT_EQ(maps.fileCount(), 1u);

  const auto report = nlohmann::json::parse(readBytes(json));
  EXPECT_EQ(report["devices"].size(), 1u);
  EXPECT_EQ(report["scale"], 4);
  ASSERT_EQ(report["halos"].size(), 2u);
  const auto &none = report["halos"][0], &whole = report["halos"][1];
  EXPECT_EQ(none["halo"], 0);
  EXPECT_GT(none["scenes"]["s"]["relativeRms"], 0);
  EXPECT_EQ(none["mean"]["relativeRms"], none["scenes"]["s"]["relativeRms"]);
  EXPECT_EQ(none["worst"], none["scenes"]["s"]);
  EXPECT_EQ(whole["worst"]["relativeRms"], 0);
  EXPECT_EQ(whole["worst"]["step"], 0);

  auto odd = bench;
  odd.insert(odd.end(), {json, "--halo", "0,7"});
  expectFailure(runXrds(odd), 2, "A halo of 7 pixels was asked for, expected a multiple of the model's window", folder,
                3);
  bench.push_back("tiles.txt");
  expectFailure(runXrds(bench), 2, "--json takes a name that ends in .json", folder, 3);
}

}  // namespace
}  // namespace xrds::test
