// Which render to make, told from two cheap ones.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

using Json = nlohmann::json;

constexpr int kWidth = 64, kHeight = 48, kScale = 4;

// Stripes of light with noise of a standard deviation that one sample divides by the root of the samples.
Layer noisyColour(double samples, int stripe, unsigned seed) {
  const auto random = std::make_shared<std::mt19937>(seed);
  return {"Combined", "RGB", [=](int x, int, int) {
            std::normal_distribution<double> noise(0, 0.2 / std::sqrt(samples));
            return static_cast<float>(0.3 + 0.1 * (x / stripe % 2) + noise(*random));
          }};
}

Layer times(float factor, Layer layer) {
  layer.pixels = [factor, pixels = layer.pixels](int x, int y, int c) { return factor * pixels(x, y, c); };
  return layer;
}

// The plain kernels start at once.
const std::map<std::string, std::string> kQuickly{{"XRDS_KERNEL_FAMILY", "plain"}, {"XRDS_DENOISERS", "/nowhere"}};

struct CliAdvise : testing::Test {
  TemporaryFolder folder;
  std::string low = (folder / "low.exr").string(), full = (folder / "full.exr").string(),
              json = (folder / "advice.json").string(), ways = (folder / "ways.json").string();

  // Two ways with the smallest shipped model: noise counts 2 dB an octave with merging, 1 dB without.
  CliAdvise() {
    writeRenders({}, {});
    Json all;
    for (const bool merges : {false, true}) {
      Json one = way(merges ? "merging" : "plain", merges ? -2 : -1);
      one["merges"] = merges;
      all["ways"].push_back(one);
    }
    std::ofstream(ways) << all;
  }

  static Json way(const char* name, double perNoise) {
    return {{"name", name},
            {"model", "xrds-x4-nano"},
            {"scale", 4},
            {"guides", "rendered"},
            {"merges", false},
            {"denoisesFirst", false},
            {"takesFullColour", false},
            {"ratios", {4}},
            {"noise", {-20, 0}},
            {"spread", 0.5},
            {"coefficients", {{"constant", 20}, {"noise", perNoise}, {"detail", 0}, {"guideNoise", 0}}}};
  }

  /// With the render's own guides, and, half a decibel better, with free ones. No model: a denoiser alone.
  void writeWaysOfOneRender(const std::string& model) const {
    Json all;
    for (const char* guides : {"rendered", "free"}) {
      Json one = way(guides, -1);
      one.update({{"model", model}, {"scale", 1}, {"guides", guides}, {"ratios", Json::array()}});
      all["ways"].push_back(one);
    }
    all["ways"][1]["coefficients"]["constant"] = 20.5;
    std::ofstream(ways) << all;
  }

  void writeRenders(const std::map<std::string, std::string>& lowTexts,
                    const std::map<std::string, std::string>& fullTexts, float fullLight = 1) const {
    const Box small = boxOf(kWidth, kHeight), large = boxOf(kScale * kWidth, kScale * kHeight);
    writeParts(low, {{small, small, {noisyColour(64, 8, 1)}, {}, lowTexts}});
    writeParts(full, {{large,
                       large,
                       {times(fullLight, noisyColour(16, 8 * kScale, 2)), albedoLayer("albedo", kScale * kWidth),
                        normalLayer("normal", kScale * kWidth)},
                       {},
                       fullTexts}});
  }

  Ended advise(const std::vector<std::string>& more,
               const std::map<std::string, std::string>& environment = kQuickly) const {
    std::vector<std::string> all{"advise", low, full, "--samples", "64,16", "--ways", ways, "--json", json};
    all.insert(all.end(), more.begin(), more.end());
    return runXrds(all, {.environment = environment});
  }
  Json written() const { return Json::parse(readBytes(json)); }
};

TEST_F(CliAdvise, TellsOfTheSceneAlone) {
  const Ended ended = advise({"--scene-only"});
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  const Json scene = written()["scene"];
  const double slope = 0.76;  // of the sRGB curve at the stripes' radiance, roughly
  EXPECT_NEAR(scene["noise"], 2 * std::log2(0.2 * slope), 0.7);
  EXPECT_NEAR(scene["detail"], 2 * std::log2(0.1 * slope) + std::log2(7.0 / 63), 0.5) << "7 edges among 63 steps";
  EXPECT_FALSE(written().contains("plans"));
  EXPECT_NE(ended.output.find("One sample a pixel has a noise of"), std::string::npos) << ended.output;
}

TEST_F(CliAdvise, TheOrderOfTheFilesIsFree) {
  advise({"--scene-only"});
  const Json first = written();
  ASSERT_EQ(runXrds({"advise", full, low, "--samples", "64,16", "--scene-only", "--json", json}).exitCode, 0);
  EXPECT_EQ(written(), first);
}

TEST_F(CliAdvise, PlansWithinATime) {
  const Ended ended = advise({"--render-seconds", "4,16", "--within", "30"});  // 1 s a sample of all pixels
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  const Json advice = written(), advised = advice["advised"];
  EXPECT_DOUBLE_EQ(advice["render"]["start"], 0);
  EXPECT_EQ(advised["way"], "merging");
  EXPECT_EQ(advised["samples"], Json({{"low", 64.0}, {"full", 16.0}})) << "20 s; the next ones would take 40";
  EXPECT_NEAR(advised["renderSeconds"], 20, 1e-9);
  const double noise = advice["scene"]["noise"];
  EXPECT_NEAR(advised["psnr"], 20 - 2 * (noise - std::log2(64 + 16 * 16)), 1e-9);
  EXPECT_GT(advice["modelSeconds"]["xrds-x4-nano"], 0);
  EXPECT_EQ(advised["steps"].size(), 3U);
  EXPECT_NE(ended.output.find("xrds upscale low.exr full.exr -o out.exr --model xrds-x4-nano"), std::string::npos)
      << ended.output;
  double seconds = 0, psnr = 0;
  for (const Json& plan : advice["plans"]) {  // each better than all that are quicker
    EXPECT_GT(plan["renderSeconds"].get<double>() + plan["afterSeconds"].get<double>(), seconds);
    EXPECT_GT(plan["psnr"], psnr);
    seconds = plan["renderSeconds"].get<double>() + plan["afterSeconds"].get<double>();
    psnr = plan["psnr"];
  }
}

TEST_F(CliAdvise, OneRenderWithItsOwnGuidesOrCleanOnes) {
  writeWaysOfOneRender("xrds-x1-compact");
  std::filesystem::create_directory(folder / "models");  // a small one of that name
  std::filesystem::copy_file(std::filesystem::path(XRDS_GOLDEN_FOLDER) / "s1_kernels_aux_skip.model.safetensors",
                             folder / "models" / "xrds-x1-compact.safetensors");
  auto environment = kQuickly;
  environment["XRDS_MODELS"] = (folder / "models").string();
  const Ended ended = advise({"--render-seconds", "4,16", "--guide-seconds", "0.25"}, environment);
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  const Json advice = written();
  std::map<std::string, Json> last;
  for (const Json& plan : advice["plans"]) last[plan["way"]] = plan;
  ASSERT_EQ(last.size(), 2U);
  EXPECT_EQ(last["rendered"]["samples"]["low"], 0.0);
  EXPECT_EQ(last["rendered"]["steps"][1], "xrds upscale full.exr -o out.exr --model xrds-x1-compact");
  EXPECT_EQ(last["free"]["steps"][2], "xrds upscale full.exr guides.exr -o out.exr --model xrds-x1-compact");
}

TEST_F(CliAdvise, NamesTheCommandThatDenoisesWhereThereAreNetworks) {
  writeWaysOfOneRender("");
  const auto lastSteps = [&](const std::map<std::string, std::string>& denoiser) {
    auto environment = kQuickly;
    for (const auto& [name, value] : denoiser) environment[name] = value;
    const Ended ended = advise({"--render-seconds", "4,16", "--guide-seconds", "0.25"}, environment);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    std::map<std::string, std::string> last;
    const Json advice = written();
    for (const Json& plan : advice["plans"]) last[plan["way"]] = plan["steps"].back();
    return last;
  };
  writeDenoisers(folder / "networks");
  std::map<std::string, std::string> last = lastSteps({{"XRDS_DENOISERS", (folder / "networks").string()}});
  EXPECT_EQ(last["rendered"], "xrds denoise full.exr -o out.exr");
  EXPECT_EQ(last["free"], "xrds denoise full.exr guides.exr -o out.exr --guides clean");
  last = lastSteps({{"XRDS_OIDN", XRDS_FAKE_OIDN}});
  EXPECT_EQ(last["rendered"], "denoise it with Open Image Denoise and its albedo and normal");
  EXPECT_EQ(last["free"], "denoise it with Open Image Denoise and the albedo and normal of guides.exr");
}

TEST_F(CliAdvise, PlansForAnErrorAndSaysWhereThereIsNone) {
  EXPECT_EQ(advise({"--render-seconds", "4,16", "--reach", "20"}).exitCode, 0);
  EXPECT_GE(written()["advised"]["psnr"], 20);
  const Ended none = advise({"--render-seconds", "4,16", "--reach", "90"});
  EXPECT_EQ(none.exitCode, 7) << none.error;
  EXPECT_NE(none.error.find("No plan is predicted to reach 90 dB"), std::string::npos) << none.error;
  EXPECT_TRUE(written()["advised"].is_null());
  Json all;
  all["ways"] = {way("of dark scenes", -1)};
  all["ways"][0]["noise"] = {-90, -80};
  std::ofstream(ways) << all;
  for (const std::vector<std::string>& asked : {std::vector<std::string>{}, {"--within", "90"}}) {
    std::vector<std::string> more{"--render-seconds", "4,16"};
    more.insert(more.end(), asked.begin(), asked.end());
    const Ended unmeasured = advise(more);
    EXPECT_EQ(unmeasured.exitCode, 7) << unmeasured.error;
    EXPECT_NE(unmeasured.error.find("none was measured at the noise"), std::string::npos) << unmeasured.error;
  }
}

TEST_F(CliAdvise, WarnsOfOtherLight) {
  EXPECT_EQ(advise({"--scene-only"}).error, "");
  writeRenders({}, {}, 0.5F);
  const Ended ended = advise({"--scene-only"});
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_NE(ended.error.find("differ by 33 %: they are of other light"), std::string::npos) << ended.error;
}

TEST_F(CliAdvise, LeavesScalesOutThatDoNotDivideTheFrame) {
  const Box small = boxOf(kWidth - 1, kHeight), large = boxOf(2 * (kWidth - 1), 2 * kHeight);
  writeParts(low, {{small, small, {noisyColour(64, 8, 1)}}});
  writeParts(
      full, {{large,
              large,
              {noisyColour(16, 16, 2), albedoLayer("albedo", 2 * kWidth - 2), normalLayer("normal", 2 * kWidth - 2)}}});
  Json all;
  all["ways"] = {way("by 4", -1), way("by 2", -1)};
  all["ways"][1].update({{"model", "xrds-x2-live"}, {"scale", 2}});
  std::ofstream(ways) << all;
  const Ended ended = advise({"--render-seconds", "4,16"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_NE(ended.output.find("126 x 96 pixels are no multiple of 4"), std::string::npos) << ended.output;
  const Json plans = written()["plans"];
  EXPECT_FALSE(plans.empty());
  for (const Json& plan : plans) EXPECT_EQ(plan["scale"], 2);
}

TEST_F(CliAdvise, ReadsSamplesAndSecondsFromTheMetadata) {
  writeRenders({{"cycles.ViewLayer.samples", "64"}, {"cycles.ViewLayer.total_time", "00:05.00"}},
               {{"cycles.ViewLayer.samples", "16"}, {"cycles.ViewLayer.total_time", "00:17.00"}});
  const Ended ended = runXrds({"advise", low, full, "--ways", ways, "--json", json},
                              {.environment = {{"XRDS_KERNEL_FAMILY", "plain"}, {"XRDS_DENOISERS", "/nowhere"}}});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(written()["samples"], Json({{"low", 64.0}, {"full", 16.0}}));
  EXPECT_NEAR(written()["render"]["start"], 1, 1e-9);  // 5 s for 4 samples of all pixels, 17 s for 16
  EXPECT_TRUE(written()["advised"].is_null()) << "nothing was asked for";
}

TEST_F(CliAdvise, SamplesAndSecondsMustBeKnown) {
  expectFailure(runXrds({"advise", low, full}), 2, "--samples LOW,FULL", folder, 3);
  expectFailure(runXrds({"advise", low, full, "--samples", "64,16"}), 2, "--render-seconds LOW,FULL", folder, 3);
  writeRenders({{"cycles.ViewLayer.total_time", "00:00.00"}}, {{"cycles.ViewLayer.total_time", "00:09.00"}});
  expectFailure(runXrds({"advise", low, full, "--samples", "64,16"}), 2, "--render-seconds LOW,FULL", folder, 3);
  expectFailure(runXrds({"advise", full, full, "--samples", "64,16"}), 3, "same size", folder, 3);
  expectFailure(advise({"--render-seconds", "1,2", "--within", "3", "--reach", "4"}), 2, "--reach", folder, 3);
}

TEST_F(CliAdvise, AFileThatTellsNoWaysIsRefused) {
  std::ofstream(ways) << "{";
  expectFailure(advise({"--render-seconds", "1,2"}), 4, "does not tell the ways", folder, 3);
}

}  // namespace
}  // namespace xrds::test
