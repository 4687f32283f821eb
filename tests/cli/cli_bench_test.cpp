// bench quality, on scenes made up here.
#include <nlohmann/json.hpp>

#include "image/metrics/metrics.h"
#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

Part partOf(int width, int height, std::vector<Layer> layers) {
  return {boxOf(width, height), boxOf(width, height), std::move(layers)};
}

// A full-resolution render: colour, a little off by `error`, albedo, normal and, if asked for, depth.
void writeFull(const std::filesystem::path& path, float error, bool withDepth = false) {
  const Layer colour = colourLayer("", 40);
  std::vector<Layer> layers{{"ViewLayer.Combined", "RGB",
                             [&](int x, int y, int c) { return colour.pixels(x, y, c) + error * float((x + y) % 2); }},
                            albedoLayer("ViewLayer.Denoising Albedo", 40),
                            normalLayer("ViewLayer.Denoising Normal", 40)};
  if (withDepth) layers.push_back({"ViewLayer.Denoising Depth", "Z", [](int x, int, int) { return 1.F + float(x); }});
  writeParts(path, {partOf(40, 32, layers)});
}

/// Scenes s1 and s2, whole for scales 1 and 4, and s3 without a colour of 64 samples; finished images of s1 and s2.
struct SceneFolder {
  TemporaryFolder folder, finished;
  std::string val = (folder / "").string(), model = goldenModel("s4_guided");

  SceneFolder() {
    for (const char* scene : {"s1", "s2", "s3"}) {
      writeFull(folder / (std::string(scene) + "_gt.exr"), 0);
      writeFull(folder / (std::string(scene) + "_aux16.exr"), 0.1F);
    }
    for (const char* scene : {"s1", "s2"}) {
      writeParts(folder / (std::string(scene) + "_lr64.exr"), {partOf(10, 8, {colourLayer("", 10)})});
      writeFull(finished / (std::string(scene) + "_other.exr"), 0.02F);
    }
  }
  Ended run(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"bench", "quality", val};
    all.insert(all.end(), more.begin(), more.end());
    return runXrds(all);
  }
};

TEST(CliBenchQuality, ModelsThatTakeDepthNeedItOfEveryScene) {
  const SceneFolder scenes;
  const std::vector<std::string> both{"--model", scenes.model, "--model", goldenModel("s4_depth")};
  writeFull(scenes.folder / "s1_aux16.exr", 0.1F, true);
  const Ended one = scenes.run(both);
  EXPECT_EQ(one.exitCode, 3) << one.output;
  EXPECT_TRUE(contains(one.error, "No depth in") && contains(one.error, "s2_aux16.exr")) << one.error;
  writeFull(scenes.folder / "s2_aux16.exr", 0.1F, true);
  const Ended all = scenes.run(both);
  EXPECT_TRUE(contains(all.output, "s4_depth.model")) << all.output << all.error;
}

TEST(CliBenchQuality, ComparesModelsBaselinesAndFinishedImages) {
  const SceneFolder scenes;
  const TemporaryFolder out;
  const Ended ended = scenes.run({"--model", scenes.model, "--also", "other tool=" + (scenes.finished / "").string(),
                                  "--json", (out / "x4.json").string(), "--markdown", (out / "x4.md").string(),
                                  "--write", (out / "images").string()});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  for (const char* words : {"average samples 20. 2 scenes", "1 skipped", "bicubic", "demodulated", "guided",
                            "s4_guided.model", "other tool"})
    EXPECT_TRUE(contains(ended.output, words)) << ended.output;
  EXPECT_TRUE(contains(readBytes(out / "x4.md"), "| guided |")) << readBytes(out / "x4.md");

  const auto json = nlohmann::json::parse(readBytes(out / "x4.json"));
  EXPECT_EQ(json["averageSamples"], 20);
  EXPECT_EQ(json["skipped"], nlohmann::json({"s3"}));
  ASSERT_EQ(json["methods"].size(), 5U);
  const auto &guided = json["methods"][2], &trained = json["methods"][3], &other = json["methods"][4];
  EXPECT_GT(guided["scenes"]["s1"]["wallSeconds"], 0);
  EXPECT_FALSE(guided.contains("psnrToGuided"));
  EXPECT_TRUE(trained.contains("modelHash"));
  EXPECT_NEAR(other["psnrToGuided"], other["mean"]["psnr"].get<double>() - guided["mean"]["psnr"].get<double>(), 1e-9);
  EXPECT_FALSE(other["scenes"]["s2"].contains("wallSeconds"));
}

TEST(CliBenchQuality, WritesImagesWithTheNumbersOfUpscaleAndCompare) {
  const SceneFolder scenes;
  const TemporaryFolder out;
  const std::string upscaled = (out / "up.exr").string(), json = (out / "x4.json").string();
  ASSERT_EQ(
      scenes.run({"--model", scenes.model, "--merge", "--write", (out / "images").string(), "--json", json}).exitCode,
      0);
  ASSERT_EQ(runXrds({"upscale", (scenes.folder / "s2_lr64.exr").string(), (scenes.folder / "s2_aux16.exr").string(),
                     "-o", upscaled, "--model", scenes.model, "--samples", "64,16"})
                .exitCode,
            0);
  EXPECT_EQ(readColour((out / "images/s2_s4_guided.model.exr").string()), readColour(upscaled));
  const Metrics metrics = measure(readColour(upscaled), readColour((scenes.folder / "s2_gt.exr").string()));
  const auto scene = nlohmann::json::parse(readBytes(json))["methods"][3]["scenes"]["s2"];
  EXPECT_NEAR(scene["psnr"], metrics.psnr, 1e-9);
  EXPECT_NEAR(scene["relMse"], metrics.relMse, 1e-9);
  EXPECT_NEAR(scene["flip"], metrics.flip, 1e-9);
}

TEST(CliBenchQuality, TakesTheNoisyRenderItselfAtScaleOne) {
  const SceneFolder scenes;
  const Ended ended = scenes.run({"--scale", "1", "--also", "other=" + (scenes.finished / "*_other.exr").string()});
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "average samples 16. 2 scenes")) << ended.output;
  EXPECT_TRUE(contains(ended.output, "\ninput ")) << ended.output;
  EXPECT_FALSE(contains(ended.output, "bicubic")) << ended.output;
}

TEST(CliBenchQuality, GivesEachModelItsInputsAndTakesConvergedOnesFromTheReference) {
  const SceneFolder scenes;
  const Ended ended = scenes.run({"--aux", "converged", "--precision", "fp16", "--model", goldenModel("s4_none_noaux"),
                                  "--model", goldenModel("s4_guided_albedo")});
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "albedo and normal converged. 2 scenes")) << ended.output;
}

// Networks of random weights in the place of Open Image Denoise's, as `xrds denoise` runs them.
TEST(CliBenchQuality, MeasuresTheDenoisersNetworks) {
  const SceneFolder scenes;
  const TemporaryFolder out;
  const std::string networks = (out / "").string(), json = (out / "x4.json").string();
  const StartOptions there{.environment = {{"XRDS_DENOISERS", networks}}};
  const std::vector<std::string> arguments{"bench",      "quality",    scenes.val, "--model",
                                           scenes.model, "--denoiser", "--json",   json};
  const Ended missing = runXrds(arguments, there);
  EXPECT_EQ(missing.exitCode, 4) << missing.error;
  writeDenoisers(out / "");
  const Ended ended = runXrds(arguments, there);
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "Open Image Denoise, 16 spp")) << ended.output;
  const std::string image = (out / "denoised.exr").string(), compared = (out / "compared.json").string();
  ASSERT_EQ(runXrds({"denoise", (scenes.folder / "s1_aux16.exr").string(), "-o", image}, there).exitCode, 0);
  ASSERT_EQ(runXrds({"compare", image, (scenes.folder / "s1_gt.exr").string(), "--json", compared}).exitCode, 0);
  const auto methods = nlohmann::json::parse(readBytes(json))["methods"];
  const auto found = std::find_if(methods.begin(), methods.end(),
                                  [](const auto& method) { return method["name"] == "Open Image Denoise, 16 spp"; });
  ASSERT_NE(found, methods.end());
  EXPECT_NEAR((*found)["scenes"]["s1"]["psnr"].get<double>(),
              nlohmann::json::parse(readBytes(compared))["metrics"]["psnr"].get<double>(), 1e-3);
  const Ended converged = runXrds({"bench", "quality", scenes.val, "--aux", "converged", "--denoiser"}, there);
  EXPECT_EQ(converged.exitCode, 2) << converged.error;
}

TEST(CliBenchQuality, SaysWhatDoesNotFit) {
  const SceneFolder scenes;
  const size_t files = scenes.folder.fileCount();
  const auto fails = [&](const std::vector<std::string>& more, int exitCode, const std::string& words) {
    expectFailure(scenes.run(more), exitCode, words, scenes.folder, files);
  };
  fails({"--model", scenes.model, "--scale", "2"}, 4, "upscales by 4, but --scale is 2");
  fails({"--model", goldenModel("s4_guided_extra_aux")}, 4, "use the library");
  fails({"--model", scenes.model, "--samples", "32"}, 3, "no scene with all of NAME_gt.exr, NAME_lr32.exr");
  fails({"--model", scenes.model, "--model", scenes.model}, 2, "Two methods have the name");
  fails({"--scale", "3"}, 2, "--scale");
  fails({"--aux", "many"}, 2, "converged");
  fails({"--scale", "1", "--aux", "converged"}, 2, "--samples");
  fails({"--also", "other"}, 2, "--also takes");
  fails({"--also", "other=" + (scenes.folder / "").string()}, 3, "several images of scene 's1'");
  fails({"--also", "other=" + (scenes.folder / "*_lr64.exr").string()}, 3, "expected the result's 40 x 32");
  fails({"--json", "table.txt"}, 2, "--json takes a name that ends in .json");
  fails({"--markdown", "/proc/table.md"}, 6, "takes no new files");
  const Ended none = runXrds({"bench", "quality", (scenes.folder / "absent").string()});
  EXPECT_EQ(none.exitCode, 3);
  EXPECT_TRUE(contains(none.error, "Cannot read the folder")) << none.error;
  EXPECT_EQ(runXrds({"bench"}).exitCode, 2);
}

}  // namespace
}  // namespace xrds::test
