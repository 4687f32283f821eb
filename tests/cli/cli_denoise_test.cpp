// Open Image Denoise before the network: a library of the same interface that halves radiance. The pipeline is
// homogeneous, so the result is half of that without.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

using Json = nlohmann::json;

const StartOptions kWithFake{.environment = {{"XRDS_OIDN", XRDS_FAKE_OIDN}}};

void expectHalved(const SmallFrame& frame, const std::vector<std::string>& options, const std::string& model = "") {
  const Ended plain = runXrds(frame.arguments(options, model));
  ASSERT_EQ(plain.exitCode, 0) << plain.error;
  const Image noisy = readColour(frame.out);
  const std::string file = (frame.folder / "run.json").string();
  std::vector<std::string> denoised = options;
  denoised.insert(denoised.end(), {"--denoise-first", "--json", file});
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

// Of both colours: were only one of them halved, their blend would show it.
TEST(CliDenoise, DenoisesTheFullResolutionColourOfFullModels) {
  const SmallFrame frame;
  writeParts(frame.aux, {{boxOf(40, 32),
                          boxOf(40, 32),
                          {colourLayer("Combined", 40), albedoLayer("albedo", 40), normalLayer("normal", 40)}}});
  for (const char* model : {"s4_full", "s4_full_prefilter2"})
    expectHalved(frame, {"--samples", "64,16"}, goldenModel(model));
}

TEST(CliDenoise, SaysHowToGetTheLibrary) {
  const SmallFrame frame;
  const Ended missing =
      runXrds(frame.arguments({"--denoise-first"}), {.environment = {{"XRDS_OIDN", "/nowhere/library.so"}}});
  expectFailure(missing, 5, "'/nowhere/library.so' cannot be loaded: install Open Image Denoise 2", frame.folder, 2);
}

}  // namespace
}  // namespace xrds::test
