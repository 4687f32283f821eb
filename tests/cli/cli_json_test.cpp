// --json and --quiet of upscale and compare.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

nlohmann::json jsonIn(const std::filesystem::path& path) { return nlohmann::json::parse(readBytes(path)); }

// No string of the tree reads as a sentence.
void expectNoSentence(const nlohmann::json& json) {
  if (json.is_string()) {
    EXPECT_EQ(json.get<std::string>().find(". "), std::string::npos) << json;
    EXPECT_FALSE(json.get<std::string>().ends_with(".")) << json;
  } else if (json.is_structured()) {
    for (const auto& inner : json) expectNoSentence(inner);
  }
}

TEST(CliJson, OfUpscaleHasEveryNumber) {
  const SmallFrame frame;
  const std::string reference = (frame.folder / "ref.exr").string(), json = (frame.folder / "run.json").string();
  writeParts(reference, {{boxOf(40, 32), boxOf(40, 32), {colourLayer("", 40)}}});
  const Ended ended = runXrds(frame.arguments(
      {"--json", json, "--quiet", "--reference", reference, "--check", "--profile", "--exposure", "0.5"}));
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(ended.output, "");
  EXPECT_EQ(ended.error, "");
  const auto run = jsonIn(json);
  EXPECT_EQ(run["width"], 40);
  EXPECT_EQ(run["height"], 32);
  EXPECT_EQ(run["scale"], 4);
  EXPECT_EQ(run["files"]["colour"], frame.color);
  EXPECT_EQ(run["files"]["auxiliary"], frame.aux);
  EXPECT_EQ(run["files"]["output"], frame.out);
  EXPECT_EQ(run["model"]["name"], "s4_guided.model");
  EXPECT_EQ(run["precision"], "fp32");
  EXPECT_EQ(run["exposure"], 0.5);
  EXPECT_EQ(run["tiles"]["columns"], 1);
  EXPECT_EQ(run["skip"]["share"], 0);
  EXPECT_EQ(run["repairedPixels"]["input"], 0);
  EXPECT_GT(run["deviceBytes"], 0);
  EXPECT_GT(run["device"]["memoryBytes"], 0);
  EXPECT_GT(run["computeSeconds"], 0);
  EXPECT_GT(run["seconds"], run["computeSeconds"]);
  EXPECT_GT(run["profile"].size(), 0U);
  EXPECT_EQ(run["checks"][0]["withinBound"], true);
  ASSERT_EQ(run["methods"].size(), 4U);
  EXPECT_EQ(run["methods"][3]["name"], "xrds");
  expectNoSentence(run);

  const std::string compared = (frame.folder / "metrics.json").string();
  ASSERT_EQ(runXrds({"compare", frame.out, reference, "--json", compared}).exitCode, 0);
  for (const char* key : {"psnr", "relMse", "relMseTrimmed", "relMseMedian", "relMsePercentile999", "flip"})
    EXPECT_EQ(jsonIn(compared)["metrics"][key], run["methods"][3][key]) << key;
}

TEST(CliJson, CountsWhatWasRepairedAndWhatIsMissing) {
  const SmallFrame frame;
  const Layer good = colourLayer("", 10);
  writeParts(frame.color, {{boxOf(10, 8), boxOf(10, 8), {{"", "RGB", [&](int x, int y, int c) {
                                                            return y == 2 ? NAN : good.pixels(x, y, c);
                                                          }}}}});
  const std::string json = (frame.folder / "run.json").string();
  const Ended ended = runXrds(frame.arguments({"--json", json, "--quiet"}));
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(ended.output, "");
  EXPECT_NE(ended.error.find("10 pixels of layer '(unnamed)' not finite"), std::string::npos) << ended.error;
  const auto run = jsonIn(json);
  EXPECT_EQ(run["repairedPixels"]["input"], 10);
  EXPECT_TRUE(run["files"]["reference"].is_null());
  EXPECT_TRUE(run["methods"].is_array() && run["methods"].empty());
  EXPECT_TRUE(run["profile"].is_array() && run["profile"].empty());
}

TEST(CliJson, OfCompareIsNullWhereAMetricIsInfinite) {
  const SmallFrame frame;
  const std::string json = (frame.folder / "same.json").string();
  const Ended ended = runXrds({"compare", frame.color, frame.color, "--json", json, "--quiet"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(ended.output + ended.error, "");
  const auto same = jsonIn(json);
  EXPECT_TRUE(same["metrics"]["psnr"].is_null());
  EXPECT_EQ(same["metrics"]["relMse"], 0);
  EXPECT_EQ(same["width"], 10);
  expectNoSentence(same);
  expectFailure(runXrds({"compare", frame.color, frame.color, "--json", "same.txt"}), 2,
                "--json takes a name that ends in .json", frame.folder, 3);
  expectFailure(runXrds(frame.arguments({"--json", "/proc/run.json"})), 6, "takes no new files", frame.folder, 3);
}

TEST(CliQuiet, LeavesErrorsAndTheExitCode) {
  const SmallFrame frame;
  const std::string other = (frame.folder / "other.exr").string();
  writeParts(other, {{boxOf(10, 8), boxOf(10, 8), {albedoLayer("beauty", 10)}}});
  const Ended ended = runXrds({"compare", other, frame.color, "--min-psnr", "60", "--quiet"});
  EXPECT_EQ(ended.exitCode, 7);
  EXPECT_EQ(ended.output, "");
  EXPECT_NE(ended.error.find("below 60"), std::string::npos) << ended.error;
}

}  // namespace
}  // namespace xrds::test
