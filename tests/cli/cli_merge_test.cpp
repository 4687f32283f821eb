// The colour of the full-resolution render in the auxiliary file, merged into the low-resolution colour.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

using Json = nlohmann::json;

// The frame's colour is 1 everywhere, that of the full-resolution render `full`.
using Texts = std::map<std::string, std::string>;
using Numbers = std::map<std::string, int>;
void writeColours(const SmallFrame& frame, float full, const Texts& lowTexts = {}, const Texts& fullTexts = {},
                  const Numbers& lowNumbers = {}, const Numbers& fullNumbers = {}) {
  const auto flat = [](const char* name, float value) {
    return Layer{name, "RGB", [value](int, int, int) { return value; }};
  };
  writeParts(frame.color, {{boxOf(10, 8), boxOf(10, 8), {flat("", 1)}, {}, lowTexts, {}, lowNumbers}});
  writeParts(frame.aux, {{boxOf(40, 32),
                          boxOf(40, 32),
                          {flat("Combined", full), albedoLayer("albedo", 40), normalLayer("normal", 40)},
                          {},
                          fullTexts,
                          {},
                          fullNumbers}});
}

Json jsonOf(const SmallFrame& frame, const std::vector<std::string>& more) {
  const std::string file = (frame.folder / "run.json").string();
  std::vector<std::string> all{"--json", file};
  all.insert(all.end(), more.begin(), more.end());
  const Ended ended = runXrds(frame.arguments(all));
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  Json json = Json::parse(readBytes(file));
  json["printed"] = ended.output;
  json["warned"] = ended.error;
  return json;
}

TEST(CliMerge, WeighsByTheSamplesThatAreGiven) {
  const SmallFrame frame;
  writeColours(frame, 1.1F);
  const Json run = jsonOf(frame, {"--samples", "64,16"});
  EXPECT_DOUBLE_EQ(run["mergedColour"]["share"], 0.8);
  EXPECT_EQ(run["mergedColour"]["source"], "given");
  EXPECT_EQ(run["mergedColour"]["samples"], Json({64, 16}));
  EXPECT_NE(run["printed"].get<std::string>().find("merged with 'Combined'"), std::string::npos) << run["printed"];
  EXPECT_TRUE(contains(headerOf(frame.out).attributes.text("xrds:options").value_or(""), " merged=0.8"));
  const Json low = jsonOf(frame, {"--aux-colour", "never"});
  EXPECT_TRUE(low["mergedColour"].is_null());
  EXPECT_FALSE(contains(headerOf(frame.out).attributes.text("xrds:options").value_or(""), "merged"));
  EXPECT_NEAR(low["exposure"].get<double>() / run["exposure"].get<double>(), 0.2 + 0.8 * 1.1, 1e-4);
}

// Models that take neither albedo nor normal have the merged colour, too.
TEST(CliMerge, MergesForModelsOfTheColourAlone) {
  const SmallFrame frame;
  writeColours(frame, 1.1F);
  const std::string plain = goldenModel("s4_none_noaux"), file = (frame.folder / "run.json").string();
  const auto run = [&](std::vector<std::string> inputs, const std::vector<std::string>& more) {
    std::vector<std::string> all{"upscale"};
    all.insert(all.end(), inputs.begin(), inputs.end());
    all.insert(all.end(), {"-o", frame.out, "--model", plain, "--json", file});
    all.insert(all.end(), more.begin(), more.end());
    const Ended ended = runXrds(all);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    Json json = Json::parse(readBytes(file));
    json["warned"] = ended.error;
    return json;
  };
  const Json merged = run({frame.color, frame.aux}, {"--samples", "64,16"});
  EXPECT_DOUBLE_EQ(merged["mergedColour"]["share"], 0.8);
  EXPECT_EQ(merged["warned"].get<std::string>().find("is not used"), std::string::npos) << merged["warned"];
  const Json low = run({frame.color, frame.aux}, {"--aux-colour", "never"});
  EXPECT_TRUE(low["mergedColour"].is_null());
  EXPECT_NE(low["warned"].get<std::string>().find("is not used"), std::string::npos) << low["warned"];
  EXPECT_NEAR(low["exposure"].get<double>() / merged["exposure"].get<double>(), 0.2 + 0.8 * 1.1, 1e-4);
  writeColours(frame, 0.5F);
  EXPECT_TRUE(run({frame.color, frame.aux}, {})["mergedColour"].is_null()) << "other light";
  EXPECT_TRUE(run({frame.color}, {})["mergedColour"].is_null());
}

TEST(CliMerge, EstimatesTheShareWhereNoSamplesAreKnown) {
  const SmallFrame frame;
  writeColours(frame, 1);
  const Json run = jsonOf(frame, {});
  EXPECT_EQ(run["mergedColour"]["source"], "noise");
  EXPECT_FALSE(run["mergedColour"].contains("samples"));
}

TEST(CliMerge, TakesTheSamplesFromTheMetadata) {
  const SmallFrame frame;
  writeColours(frame, 1, {{"cycles.ViewLayer.samples", "64"}}, {{"cycles.ViewLayer.samples", "16"}});
  const Json run = jsonOf(frame, {});
  EXPECT_EQ(run["mergedColour"]["source"], "metadata");
  EXPECT_DOUBLE_EQ(run["mergedColour"]["share"], 0.8);
  const Texts twoLayers{{"cycles.Front.samples", "4"}, {"cycles.Back.samples", "9"}};
  writeColours(frame, 1, twoLayers, twoLayers);
  EXPECT_EQ(jsonOf(frame, {})["mergedColour"]["source"], "noise") << "two view layers contradict each other";
  writeColours(frame, 1, {{"samplesPerPixel", "64"}}, {});
  EXPECT_EQ(jsonOf(frame, {})["mergedColour"]["source"], "noise") << "one file alone does not tell";
}

// pbrt writes a number.
TEST(CliMerge, TakesTheSamplesFromNumbers) {
  const SmallFrame frame;
  writeColours(frame, 1, {}, {}, {{"samplesPerPixel", 64}}, {{"samplesPerPixel", 16}});
  const Json run = jsonOf(frame, {});
  EXPECT_EQ(run["mergedColour"]["source"], "metadata");
  EXPECT_EQ(run["mergedColour"]["samples"], Json({64, 16}));
  for (const int none : {0, -3}) {
    writeColours(frame, 1, {}, {}, {{"samplesPerPixel", none}}, {{"samplesPerPixel", 16}});
    EXPECT_EQ(jsonOf(frame, {})["mergedColour"]["source"], "noise") << none;
  }
}

TEST(CliMerge, LeavesTheColourOfOtherLightAlone) {
  const SmallFrame frame;
  writeColours(frame, 0.5F);
  const Json run = jsonOf(frame, {});
  EXPECT_TRUE(run["mergedColour"].is_null());
  EXPECT_NE(run["warned"].get<std::string>().find("of other light"), std::string::npos) << run["warned"];
  EXPECT_DOUBLE_EQ(jsonOf(frame, {"--samples", "16,1"})["mergedColour"]["share"], 0.5);
}

// As those of LuxCore, whose pictures are one pixel too low at every size: 3 of the full resolution between them.
TEST(CliMerge, TellsOfRendersThatDoNotLineUp) {
  const SmallFrame frame;
  for (const int down : {0, 3}) {
    const auto bright = [](int x, int y) { return (x / 11 + (y + 80) / 10) % 2 == 0 ? 1.0F : 0.2F; };
    const Layer low{"", "RGB", [&](int x, int y, int) {
                      float sum = 0;
                      for (int i = 0; i < 16; ++i) sum += bright(4 * x + i % 4, 4 * y + i / 4 - down);
                      return sum / 16;
                    }};
    const Layer full{"Combined", "RGB", [&](int x, int y, int) { return bright(x, y); }};
    writeParts(frame.color, {{boxOf(20, 16), boxOf(20, 16), {low}}});
    writeParts(frame.aux,
               {{boxOf(80, 64), boxOf(80, 64), {full, albedoLayer("albedo", 80), normalLayer("normal", 80)}}});
    const std::string warned = jsonOf(frame, {"--samples", "64,16"})["warned"];
    EXPECT_EQ(contains(warned, "moved by 3 pixels down, 'Combined' fits"), down == 3) << warned;
    EXPECT_EQ(contains(warned, "part of the picture"), down == 3) << warned;
  }
}

TEST(CliMerge, TellsOfAColourThatDoesNotCoverTheFrame) {
  const SmallFrame frame;
  writeColours(frame, 1);
  const auto flat = [](int, int, int) { return 1.0F; };
  const Layer albedo = albedoLayer("albedo", 40), normal = normalLayer("normal", 40);
  writeParts(frame.aux, {{boxOf(40, 32), boxOf(40, 32), {albedo, normal}, "guides"},
                         {{0, 0, 29, 31}, boxOf(40, 32), {{"Combined", "RGB", flat}}, "colour"}});
  const Json run = jsonOf(frame, {});
  EXPECT_TRUE(run["mergedColour"].is_null());
  EXPECT_NE(run["warned"].get<std::string>().find("'Combined' does not cover the frame"), std::string::npos)
      << run["warned"];
  expectFailure(runXrds(frame.arguments({"--samples", "64,16"})), 3, "does not cover the frame", frame.folder, 4);
}

TEST(CliMerge, SaysWhatSamplesNeedWhereThereIsNoColour) {
  const SmallFrame frame;
  expectFailure(runXrds(frame.arguments({"--samples", "64,16"})), 3, "--aux-colour never goes with it", frame.folder,
                2);
  EXPECT_EQ(runXrds(frame.arguments({"--samples", "64,16", "--aux-colour", "never"})).exitCode, 0);
}

// Golden models under the names of the shipped ones.
TEST(CliMerge, TakesTheModelThatSuitsWhatTheFilesHold) {
  const SmallFrame frame;
  const std::filesystem::path models = frame.folder / "models";
  std::filesystem::create_directory(models);
  for (const auto& [name, golden] : {std::pair("xrds-x4-full", "s4_full"), std::pair("xrds-x4-compact", "s4_kernels"),
                                     std::pair("xrds-x4-live", "s4_guided")})
    std::filesystem::copy_file(goldenModel(golden), models / (std::string(name) + ".safetensors"));
  const std::string file = (frame.folder / "run.json").string();
  const auto chosen = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"upscale", frame.color, frame.aux, "-o", frame.out, "--json", file};
    all.insert(all.end(), more.begin(), more.end());
    const Ended ended = runXrds(all, {.environment = {{"XRDS_MODELS", models.string()}}});
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    const Json json = Json::parse(readBytes(file));
    EXPECT_EQ(json["mergedColour"].is_null(), json["model"]["name"] != "xrds-x4-full");
    return json["model"]["name"].get<std::string>();
  };
  EXPECT_EQ(chosen({}), "xrds-x4-compact");  // no colour in the auxiliary file
  writeColours(frame, 1.1F);
  EXPECT_EQ(chosen({}), "xrds-x4-full");
  EXPECT_EQ(chosen({"--samples", "64,16"}), "xrds-x4-full");
  EXPECT_EQ(chosen({"--aux-colour", "never"}), "xrds-x4-compact");
  writeColours(frame, 0.5F);  // of other light
  EXPECT_EQ(chosen({}), "xrds-x4-compact");
  EXPECT_EQ(chosen({"--samples", "64,16"}), "xrds-x4-full");
  for (const auto& [samples, model] : {std::pair("4", "xrds-x4-live"), std::pair("16", "xrds-x4-compact")}) {
    writeColours(frame, 0.5F, {{"cycles.ViewLayer.samples", samples}});
    EXPECT_EQ(chosen({}), model) << samples;
    EXPECT_EQ(chosen({"--aux-colour", "never"}), model) << samples;
    EXPECT_EQ(chosen({"--skip", "safe"}), "xrds-x4-compact") << samples;  // which the others refuse
    EXPECT_EQ(chosen({"--skip", "safe", "--aux-colour", "never"}), "xrds-x4-compact") << samples;
  }
}

TEST(CliMerge, RefusesAFullModelWithoutTheColour) {
  const SmallFrame frame;
  writeColours(frame, 1);
  const Ended ended = runXrds(frame.arguments({"--aux-colour", "never"}, goldenModel("s4_full")));
  expectFailure(ended, 3, "takes the colour of the full-resolution render", frame.folder, 2);
  EXPECT_NE(ended.error.find("leave out --aux-colour never"), std::string::npos) << ended.error;
}

TEST(CliMerge, NeedsALayerThatIsNamed) {
  const SmallFrame frame;
  EXPECT_TRUE(jsonOf(frame, {})["mergedColour"].is_null());  // the auxiliary file has no colour
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--aux-colour", "beauty"}, {"--samples", "64,16"}}) {
    const Ended ended = runXrds(frame.arguments(options));
    EXPECT_EQ(ended.exitCode, 3) << ended.error;
    EXPECT_NE(ended.error.find("--aux-colour"), std::string::npos) << ended.error;
  }
  EXPECT_EQ(runXrds(frame.arguments({"--samples", "64"})).exitCode, 2);
}

}  // namespace
}  // namespace xrds::test
