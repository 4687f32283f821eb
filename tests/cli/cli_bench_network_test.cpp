// bench network, with small models and frames.
#include <nlohmann/json.hpp>

#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

using Json = nlohmann::json;

Ended bench(std::vector<std::string> more) {
  more.insert(more.begin(), {"bench", "network", "--runs", "2"});
  return runXrds(more);
}

TEST(CliBenchNetwork, MeasuresEveryModelSizeAndPrecision) {
  const TemporaryFolder out;
  const std::string json = (out / "network.json").string();
  const Ended ended = bench({"--model", goldenModel("s4_guided"), "--model", goldenModel("s2_bicubic_linear"), "--size",
                             "64,32", "--json", json});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  for (const char* words : {"median of 2 frames", "s4_guided.model", "s2_bicubic_linear.model", "engine error"})
    EXPECT_TRUE(contains(ended.output, words)) << ended.output;

  const Json report = Json::parse(readBytes(json));
  ASSERT_EQ(report["devices"].size(), 1U);
  ASSERT_EQ(report["networks"].size(), 8U);
  for (const Json& row : report["networks"]) {
    EXPECT_EQ(row["device"], report["devices"][0]["uuid"]);
    const Json &wall = row["wallSeconds"], &memory = row["memory"];
    EXPECT_GT(wall["least"], 0);
    EXPECT_LE(wall["least"], wall["median"]);
    EXPECT_LE(wall["median"], wall["most"]);
    EXPECT_LE(row["deviceSeconds"]["least"], wall["most"]);
    EXPECT_GE(memory["plannedBytes"], memory["lowerBoundBytes"]);
    EXPECT_GE(memory["unaliasedBytes"], memory["plannedBytes"]);
    EXPECT_GE(memory["deviceBytes"], memory["plannedBytes"]);
    uint64_t multiplyAdds = 0;
    for (const Json& kernel : row["kernels"]) multiplyAdds += kernel["multiplyAdds"].get<uint64_t>();
    const uint64_t stated = row["multiplyAdds"].get<uint64_t>() + row["attentionMultiplyAdds"].get<uint64_t>();
    EXPECT_EQ(multiplyAdds, stated);
    // Joined maps save 2 (k C) (k C - C) a pixel in the k-th of an RDST's three layers, here of C = 8.
    const uint64_t side = row["width"].get<uint64_t>() / (row["model"] == "s4_guided.model" ? 4 : 2);
    EXPECT_EQ(row["multiplyAdds"].get<uint64_t>() + side * side * 16 * 8 * 8,
              row["networkMultiplyAdds"].get<uint64_t>());
  }
  EXPECT_EQ(report["networks"][0]["width"], 32);
  EXPECT_EQ(report["networks"][7]["width"], 64);
  EXPECT_GT(report["networks"][0]["multiplyAdds"], 0);
  const auto planned = [&](size_t row) { return report["networks"][row]["memory"]["plannedBytes"].get<uint64_t>(); };
  EXPECT_LT(planned(1), planned(0)) << "fp16 takes no less than fp32";
}

TEST(CliBenchNetwork, TellsTheEnginesErrorInBothPrecisions) {
  const TemporaryFolder out;
  const std::string json = (out / "network.json").string();
  ASSERT_EQ(bench({"--model", goldenModel("s4_guided"), "--size", "32", "--json", json}).exitCode, 0);
  const Json rows = Json::parse(readBytes(json))["accuracies"];
  ASSERT_EQ(rows.size(), 2U);
  const Json &full = rows[0]["engineError"], &half = rows[1]["engineError"];
  EXPECT_EQ(rows[0]["precision"], "fp32");
  for (const Json& error : {full, half}) {
    EXPECT_TRUE(error["finite"].get<bool>() && error["withinBound"].get<bool>()) << error;
    EXPECT_GE(error["worstRelativeRms"], error["relativeRms"]);
    EXPECT_FALSE(error["worstOperator"].get<std::string>().empty());
  }
  EXPECT_GT(full["relativeRms"], 0);
  EXPECT_LT(full["relativeRms"], 1e-4);
  EXPECT_GT(half["relativeRms"], full["relativeRms"]);
  EXPECT_FALSE(full.contains("relativeMaxToFp32"));
  EXPECT_GE(half["relativeMaxToFp32"], half["relativeRmsToFp32"]);
  EXPECT_NEAR(half["relativeRmsToFp32"].get<double>() / half["relativeRms"].get<double>(), 1, 0.1);
}

TEST(CliBenchNetwork, TakesTheImageErrorFromScenes) {
  const TemporaryFolder scenes;
  const auto write = [&](const char* name, int side, float error) {
    Layer colour = colourLayer("ViewLayer.Combined", side);
    const Pixels exact = colour.pixels;
    colour.pixels = [exact, error](int x, int y, int c) { return exact(x, y, c) + error * float((x + y) % 2); };
    writeParts(
        scenes / name,
        {{boxOf(side, side),
          boxOf(side, side),
          {colour, albedoLayer("ViewLayer.Denoising Albedo", side), normalLayer("ViewLayer.Denoising Normal", side)}}});
  };
  write("a_gt.exr", 32, 0);
  write("a_aux16.exr", 32, 0.1F);
  write("a_lr64.exr", 8, 0);
  const std::string json = (scenes / "network.json").string(), model = goldenModel("s4_guided");
  const std::vector<std::string> asked{"--size",
                                       "32",
                                       "--precision",
                                       "fp32",
                                       "--no-check",
                                       "--scenes",
                                       (scenes / "").string(),
                                       "--json",
                                       json,
                                       "--model",
                                       model,
                                       "--model",
                                       goldenModel("s2_guided")};
  const Ended ended = bench(asked);
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "no image error: s2_guided.model: ")) << ended.output;
  const Json rows = Json::parse(readBytes(json))["accuracies"];
  EXPECT_FALSE(rows[0].contains("engineError"));
  EXPECT_TRUE(contains(rows[1]["imageErrorMissing"], "NAME_x2lr64.exr")) << rows[1];

  const std::string quality = (scenes / "quality.json").string();
  ASSERT_EQ(runXrds({"bench", "quality", (scenes / "").string(), "--model", model, "--json", quality}).exitCode, 0);
  const Json mean = Json::parse(readBytes(quality))["methods"][3]["mean"];
  EXPECT_EQ(rows[0]["imageError"]["scenes"], 1);
  EXPECT_NEAR(rows[0]["imageError"]["psnr"], mean["psnr"], 1e-9);
  EXPECT_NEAR(rows[0]["imageError"]["relMse"], mean["relMse"], 1e-9);
}

TEST(CliBenchNetwork, ReportsAFrameThatTheDeviceRefuses) {
  const TemporaryFolder out;
  const std::string json = (out / "network.json").string();
  const Ended ended = bench({"--model", goldenModel("s2_bicubic_linear"), "--size", "32,65536", "--precision", "fp32",
                             "--no-check", "--json", json});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "refused: s2_bicubic_linear.model, fp32, 65536: ")) << ended.output;
  const Json rows = Json::parse(readBytes(json))["networks"];
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_FALSE(rows[0].contains("refused"));
  EXPECT_TRUE(rows[1].contains("refused") && !rows[1].contains("wallSeconds")) << rows[1];
  EXPECT_GT(rows[1]["memory"]["plannedBytes"], rows[0]["memory"]["plannedBytes"]);
}

TEST(CliBenchNetwork, SaysWhatDoesNotFit) {
  const TemporaryFolder folder;
  const std::string model = goldenModel("s4_guided");
  const auto fails = [&](const std::vector<std::string>& more, int exitCode, const std::string& words) {
    expectFailure(bench(more), exitCode, words, folder, 0);
  };
  fails({"--model", model, "--size", "30"}, 2, "--size 30 is no multiple of the scale 4");
  fails({"--model", model, "--size", "0"}, 2, "--size");
  fails({"--model", model, "--precision", "fp8"}, 2, "--precision");
  fails({"--model", model, "--runs", "0"}, 2, "--runs");
  fails({"--model", model, "--model", model}, 2, "Two models have the name");
  fails({"--model", "absent"}, 4, "There is no model 'absent'");
  fails({"--model", model, "--device", "absent"}, 5, "absent");
  fails({"--model", model, "--json", "network.txt"}, 2, "--json takes a name that ends in .json");
  fails({"--model", model, "--json", "/proc/network.json"}, 6, "takes no new files");
}

}  // namespace
}  // namespace xrds::test
