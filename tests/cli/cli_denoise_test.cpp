// Open Image Denoise before the network: a library of the same interface that halves radiance and albedo. The pipeline
// is homogeneous in radiance, so with clean guides the result is half of that without.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

using Json = nlohmann::json;

const StartOptions kWithFake{.environment = {{"XRDS_OIDN", XRDS_FAKE_OIDN}, {"XRDS_DENOISERS", "/nowhere"}}};

void expectHalved(const SmallFrame& frame, const std::vector<std::string>& options, const std::string& model = "") {
  const Ended plain = runXrds(frame.arguments(options, model));
  ASSERT_EQ(plain.exitCode, 0) << plain.error;
  const Image noisy = readColour(frame.out);
  const std::string file = (frame.folder / "run.json").string();
  std::vector<std::string> denoised = options;
  denoised.insert(denoised.end(), {"--denoise-first", "--clean-guides", "--json", file});
  const Ended ended = runXrds(frame.arguments(denoised, model), kWithFake);
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_NE(ended.output.find("Denoised first, by Open Image Denoise 2.7.7."), std::string::npos) << ended.output;
  EXPECT_EQ(Json::parse(readBytes(file))["denoisedBy"], "Open Image Denoise 2.7.7");
  const Image result = readColour(frame.out);
  ASSERT_EQ(result.pixels.size(), noisy.pixels.size());
  for (size_t i = 0; i < noisy.pixels.size(); ++i)
    EXPECT_NEAR(result.pixels[i], 0.5F * noisy.pixels[i], 1e-4F * (1 + noisy.pixels[i])) << i;
}

TEST(CliDenoise, GivesTheNetworkWhatTheLibraryMakes) { expectHalved(SmallFrame(), {}); }

// As many passes of the denoiser: were an image mirrored to another place, the mean would not be half of the picture.
TEST(CliDenoise, TakesTheMeanOfAnEnsemblesPasses) { expectHalved(SmallFrame(), {"--ensemble", "8"}); }

// The colour of the low-resolution render, `brighter` times, as that of the full-resolution one.
void writeFullColour(const SmallFrame& frame, float brighter, const std::vector<std::string>& lights = {}) {
  const Pixels low = colourLayer("", 10).pixels;
  const auto full = [&](int x, int y, int c) { return brighter * low(x / 4, y / 4, c); };
  std::vector<Layer> layers{{"Combined", "RGB", full}, albedoLayer("albedo", 40), normalLayer("normal", 40)};
  for (const std::string& light : lights) layers.push_back({light, "RGB", full});
  writeParts(frame.aux, {{boxOf(40, 32), boxOf(40, 32), layers}});
}

// Of both colours: were only one of them halved, their blend would show it.
TEST(CliDenoise, DenoisesTheFullResolutionColourOfFullModels) {
  const SmallFrame frame;
  writeFullColour(frame, 1);
  for (const char* model : {"s4_full", "s4_full_prefilter2"})
    expectHalved(frame, {"--samples", "64,16"}, goldenModel(model));
}

// Of several passes a fifth, of log(1 + e x), is of the images with their noise.
TEST(CliDenoise, KeepsAShareOfTheNoiseInAnEnsemble) {
  const SmallFrame frame;
  writeFullColour(frame, 1);
  const std::string file = (frame.folder / "run.json").string();
  const auto made = [&](const std::vector<std::string>& more) {
    std::vector<std::string> options{"--ensemble", "2", "--samples", "64,16", "--json", file};
    options.insert(options.end(), more.begin(), more.end());
    const Ended ended = runXrds(frame.arguments(options, goldenModel("s4_full")), kWithFake);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    return readColour(frame.out);
  };
  const Image noisy = made({});
  const Image mixed = made({"--denoise-first", "--clean-guides"});
  const auto exposure = Json::parse(readBytes(file))["exposure"].get<double>();
  for (size_t i = 0; i < noisy.pixels.size(); ++i) {
    const double x = noisy.pixels[i],
                 expected = std::expm1(0.8 * std::log1p(exposure * x / 2) + 0.2 * std::log1p(exposure * x)) / exposure;
    ASSERT_NEAR(mixed.pixels[i], expected, 1e-3 * (0.1 + expected)) << i;
  }
}

TEST(CliDenoise, DenoisesTheLightsOfModelsThatTakeThem) {
  const SmallFrame frame;
  writeFullColour(frame, 1, {"DiffDir", "DiffInd", "GlossDir", "GlossInd"});
  expectHalved(frame, {"--samples", "64,16"}, goldenModel("s4_lights"));
}

// A full-resolution colour 5 % brighter than the other one, four fifths of the merged one: of both is made what is 4 %
// brighter.
TEST(CliDenoise, BringsTheFullResolutionColourToTheLevelOfTheMergedOne) {
  const SmallFrame frame;
  const std::string model = goldenModel("s4_full");
  const auto denoised = [&](float brighter) {
    writeFullColour(frame, brighter);
    const Ended ended =
        runXrds(frame.arguments({"--denoise-first", "--clean-guides", "--samples", "64,16"}, model), kWithFake);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    return readColour(frame.out);
  };
  const Image same = denoised(1), brighter = denoised(1.05F);
  for (size_t i = 0; i < same.pixels.size(); ++i)
    EXPECT_NEAR(brighter.pixels[i], 1.04F * same.pixels[i], 2e-3F * (0.1F + same.pixels[i])) << i;
}

TEST(CliDenoise, DenoisesAlbedoUnlessItIsClean) {
  const SmallFrame frame, halved;
  const Pixels albedo = albedoLayer("", 40).pixels;
  const auto half = [&](int x, int y, int c) { return 0.5F * albedo(x, y, c); };
  writeParts(halved.aux, {{boxOf(40, 32), boxOf(40, 32), {{"albedo", "RGB", half}, normalLayer("normal", 40)}}});
  ASSERT_EQ(runXrds(frame.arguments({"--denoise-first"}), kWithFake).exitCode, 0);
  ASSERT_EQ(runXrds(halved.arguments({"--denoise-first", "--clean-guides"}), kWithFake).exitCode, 0);
  const Image denoised = readColour(frame.out);
  EXPECT_EQ(denoised, readColour(halved.out));
  ASSERT_EQ(runXrds(frame.arguments({"--denoise-first", "--clean-guides"}), kWithFake).exitCode, 0);
  EXPECT_NE(denoised, readColour(frame.out));

  const Ended alone = runXrds(frame.arguments({"--clean-guides"}));
  EXPECT_EQ(alone.exitCode, 2) << alone.error;
}

TEST(CliDenoise, SaysHowToGetTheLibrary) {
  const SmallFrame frame;
  const Ended missing =
      runXrds(frame.arguments({"--denoise-first"}),
              {.environment = {{"XRDS_OIDN", "/nowhere/library.so"}, {"XRDS_DENOISERS", "/nowhere"}}});
  expectFailure(missing, 5, "'/nowhere/library.so' cannot be loaded: install Open Image Denoise 2", frame.folder, 2);
}

#ifdef __linux__
TEST(CliDenoise, TellsADamagedLibrary) {
  const SmallFrame frame;
  const TemporaryFolder folder;
  const std::string library = (folder / "libFake.so.2").string(), part = (folder / "libFake_part.so.2").string();
  const auto denoised = [&] {
    return runXrds(frame.arguments({"--denoise-first"}),
                   {.environment = {{"XRDS_OIDN", library}, {"XRDS_DENOISERS", "/nowhere"}}});
  };
  std::ofstream(library) << "no library";
  expectFailure(denoised(), 5, library + "' cannot be loaded (" + library, frame.folder, 2);
  std::filesystem::copy_file(XRDS_FAKE_OIDN, library, std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(denoised().exitCode, 0);
  std::filesystem::remove(frame.out);
  std::filesystem::copy_file(XRDS_FAKE_OIDN, part);
  for (const std::string& damaged : {part, library}) {
    std::filesystem::resize_file(damaged, std::filesystem::file_size(damaged) / 4);
    expectFailure(denoised(), 5, damaged + "' is damaged, it ends too early", frame.folder, 2);
  }
}
#endif

}  // namespace
}  // namespace xrds::test
