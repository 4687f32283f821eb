// What comes out of good and of doubtful frames: pixels, windows, attributes, alpha, repairs.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

bool allFinite(const Image& image) {
  for (const float value : image.pixels)
    if (!std::isfinite(value)) return false;
  return true;
}

TEST(CliFrame, UpscalesTwoFilesAndSaysWhatItDid) {
  const SmallFrame frame;
  const Ended ended = runXrds(frame.arguments({"--preview", (frame.folder / "p.png").string()}));
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_FALSE(contains(ended.error, "warning")) << ended.error;
  EXPECT_TRUE(contains(ended.output, "40 x 32, model s4_guided.model (fp32)")) << ended.output;
  EXPECT_EQ(frame.folder.fileCount(), 4u);
  const Image result = readColour(frame.out);
  EXPECT_EQ(result.width, 40);
  EXPECT_EQ(result.height, 32);
  EXPECT_TRUE(allFinite(result));
  EXPECT_TRUE(readBytes(frame.folder / "p.png").starts_with("\x89PNG"));
}

TEST(CliFrame, FilesAndFoldersHaveAnyLetters) {
  const SmallFrame frame;
  const auto named = [&](const char* name) { return frame.folder.path().string() + "/Größe/" + name; };
  std::filesystem::create_directory(named(""));
  std::filesystem::rename(frame.color, named("日本.0001.exr"));
  std::filesystem::rename(frame.aux, named("Übung.exr"));
  std::filesystem::copy_file(goldenModel("s4_guided"), named("模型.safetensors"));
  const auto upscaled = [&](const char* colour, const char* output, const char* option, const char* report) {
    return runXrds({"upscale", named(colour), named("Übung.exr"), "-o", named(output), "--model",
                    named("模型.safetensors"), option, named(report)});
  };
  const Ended one = upscaled("日本.0001.exr", "é.exr", "--json", "é.json");
  EXPECT_EQ(one.exitCode, 0) << one.error;
  EXPECT_TRUE(contains(one.output, "model 模型")) << one.output;
  EXPECT_TRUE(contains(readBytes(named("é.json")), "Größe/é.exr"));
  const Ended many = upscaled("日本.####.exr", "结果/ñ.####.exr", "--log", "ñ.json");
  EXPECT_EQ(many.exitCode, 0) << many.error;
  EXPECT_TRUE(contains(readBytes(named("ñ.json")), "结果/ñ.0001.exr"));
  EXPECT_EQ(readColour(named("结果/ñ.0001.exr")), readColour(named("é.exr")));
  const Ended none = upscaled("没有.exr", "é.exr", "--json", "é.json");
  EXPECT_TRUE(contains(none.error, "Größe/没有.exr'")) << none.error;
}

TEST(CliFrame, TakesColourAndAuxiliaryImagesInAnyOrder) {
  const SmallFrame frame;
  ASSERT_EQ(runXrds(frame.arguments()).exitCode, 0);
  const Image expected = readColour(frame.out);
  const auto swapped = [&](const char* model) {
    return runXrds({"upscale", frame.aux, frame.color, "-o", frame.out, "--model", goldenModel(model)});
  };
  const Ended ended = swapped("s4_guided");
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(readColour(frame.out), expected);

  // Of one size, the colour is what has no albedo.
  writeParts(frame.color, {{boxOf(40, 32), boxOf(40, 32), {colourLayer("", 40)}}});
  ASSERT_EQ(runXrds(frame.arguments({}, goldenModel("s1_guided"))).exitCode, 0);
  const Image denoised = readColour(frame.out);
  const Ended ofOneSize = swapped("s1_guided");
  EXPECT_EQ(ofOneSize.exitCode, 0) << ofOneSize.error;
  EXPECT_EQ(readColour(frame.out), denoised);
}

TEST(CliFrame, HintsAtTheColourAloneOnlyWhereThatWorks) {
  const SmallFrame frame;
  const auto upscaled = [&](const std::string& file) { return runXrds({"upscale", file, "-o", frame.out}); };
  EXPECT_TRUE(contains(upscaled(frame.color).error, "--model xrds-x4-compact-plain"));
  writeParts(frame.color, {{boxOf(10, 8), boxOf(10, 8), {normalLayer("normal", 10)}}});
  const Ended ended = upscaled(frame.color);
  EXPECT_EQ(ended.exitCode, 3);
  EXPECT_FALSE(contains(ended.error, "xrds-x4-compact-plain")) << ended.error;
}

TEST(CliFrame, TakesTheModelForWhatTheFileHolds) {
  const SmallFrame frame;
  const TemporaryFolder models;
  for (const auto& [golden, shipped] : {std::pair{"s4_guided", "xrds-x4-compact"},
                                        {"s4_guided_albedo", "xrds-x4-compact-albedo"},
                                        {"s4_concat_noaux", "xrds-x4-compact-plain"}})
    std::filesystem::copy_file(goldenModel(golden), models / (std::string(shipped) + ".safetensors"));
  const StartOptions options{.environment = {{"XRDS_MODELS", (models / "").string()}}};
  const std::vector<std::string> arguments{"upscale", frame.color, frame.aux, "-o", frame.out};
  const Ended both = runXrds(arguments, options);
  EXPECT_TRUE(contains(both.output, "model xrds-x4-compact (")) << both.output << both.error;
  writeParts(frame.aux, {{boxOf(40, 32), boxOf(40, 32), {albedoLayer("albedo", 40)}}});
  const Ended albedoAlone = runXrds(arguments, options);
  EXPECT_EQ(albedoAlone.exitCode, 0);
  EXPECT_TRUE(contains(albedoAlone.output, "model xrds-x4-compact-albedo (")) << albedoAlone.output;
  EXPECT_TRUE(contains(albedoAlone.error, "has no normal")) << albedoAlone.error;

  const auto constant = [](int, int, int c) { return c == 2 ? 0.5F : 0.F; };
  writeParts(frame.aux, {{boxOf(40, 32), boxOf(40, 32), {albedoLayer("albedo", 40), {"normal", "XYZ", constant}}}});
  const Ended noNormal = runXrds(arguments, options);
  EXPECT_TRUE(contains(noNormal.output, "model xrds-x4-compact-albedo (")) << noNormal.output;
  EXPECT_TRUE(contains(noNormal.error, "The normal is the same everywhere")) << noNormal.error;
  writeParts(frame.aux, {{boxOf(40, 32), boxOf(40, 32), {{"albedo", "RGB", constant}, normalLayer("normal", 40)}}});
  const Ended noAlbedo = runXrds(arguments, options);
  EXPECT_TRUE(contains(noAlbedo.output, "model xrds-x4-compact-plain (")) << noAlbedo.output;
  EXPECT_TRUE(contains(noAlbedo.error, "The albedo is the same everywhere")) << noAlbedo.error;
}

TEST(CliFrame, TellsOfLayersThatTheModelDoesNotTake) {
  const SmallFrame frame;
  const Ended ended = runXrds(frame.arguments({"--normal", "normal", "--depth", "nowhere"}, goldenModel("s4_guided")));
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.error, "--depth is not used: model s4_guided.model does not take it.")) << ended.error;
  EXPECT_FALSE(contains(ended.error, "--normal")) << ended.error;
}

TEST(CliFrame, ReadsDepthInAnyUnitForAModelThatTakesIt) {
  const SmallFrame frame;
  const auto runWith = [&](float unit, float background, const std::vector<std::string>& more = {}) {
    const Layer depth{"depth", "Z", [=](int x, int y, int) {
                        return y == 3 ? background : unit * static_cast<float>(1 + x + y % 3);
                      }};
    writeParts(frame.aux,
               {{boxOf(40, 32), boxOf(40, 32), {albedoLayer("albedo", 40), normalLayer("normal", 40), depth}}});
    return runXrds(frame.arguments(more, goldenModel("s4_depth")));
  };
  const Ended metres = runWith(1, 0);
  EXPECT_FALSE(contains(metres.error, "warning")) << metres.error;
  const Image inMetres = readColour(frame.out);
  EXPECT_TRUE(allFinite(inMetres));
  ASSERT_EQ(runWith(1024, std::numeric_limits<float>::infinity()).exitCode, 0);
  EXPECT_EQ(readColour(frame.out).pixels, inMetres.pixels);  // the unit and the mark of the background do not matter
  ASSERT_EQ(runWith(0, 0).exitCode, 0);                      // without any distance
  EXPECT_NE(readColour(frame.out).pixels, inMetres.pixels);

  const Ended unknown = runWith(1, 0, {"--depth", "Mist"});
  EXPECT_TRUE(contains(unknown.error, "expected a layer 'Mist' with one floating-point channel")) << unknown.error;
  const Ended without = runXrds(SmallFrame().arguments({}, goldenModel("s4_depth")));
  EXPECT_TRUE(contains(without.error, "No depth in")) << without.error;
}

TEST(CliFrame, AddsDirectAndIndirectLightForAModelThatTakesThem) {
  const SmallFrame frame;
  const Pixels low = colourLayer("", 10).pixels;
  const auto light = [&](float share) { return [=](int x, int y, int c) { return share * low(x / 4, y / 4, c); }; };
  const auto runWith = [&](const std::vector<Layer>& lights, const std::vector<std::string>& more = {}) {
    std::vector<Layer> layers{{"Combined", "RGB", light(1)}, albedoLayer("albedo", 40), normalLayer("normal", 40)};
    layers.insert(layers.end(), lights.begin(), lights.end());
    writeParts(frame.aux, {{boxOf(40, 32), boxOf(40, 32), layers}});
    std::vector<std::string> arguments{"--samples", "64,16"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runXrds(frame.arguments(arguments, goldenModel("s4_lights")));
  };
  const Ended split = runWith({{"DiffDir", "RGB", light(0.5F)},
                               {"DiffInd", "RGB", light(0.25F)},
                               {"GlossDir", "RGB", light(0.125F)},
                               {"GlossInd", "RGB", light(0.5F)}});
  ASSERT_EQ(split.exitCode, 0) << split.error;
  const Image result = readColour(frame.out);
  ASSERT_EQ(
      runWith({{"d", "RGB", light(0.75F)}, {"g", "RGB", light(0.625F)}}, {"--diffuse", "d", "--glossy", "g"}).exitCode,
      0);
  EXPECT_EQ(readColour(frame.out).pixels, result.pixels);
  ASSERT_EQ(
      runWith({{"d", "RGB", light(0.5F)}, {"g", "RGB", light(0.625F)}}, {"--diffuse", "d", "--glossy", "g"}).exitCode,
      0);
  EXPECT_NE(readColour(frame.out).pixels, result.pixels);
  const Ended without = runWith({});
  EXPECT_TRUE(contains(without.error, "No diffuse light in") && contains(without.error, "--diffuse LAYER"))
      << without.error;
}

TEST(CliFrame, KeepsAttributesAndAddsItsOwn) {
  const SmallFrame frame;
  ASSERT_EQ(runXrds(frame.arguments({"--quiet", "--half", "--exposure", "0.5"})).exitCode, 0);
  const ExrPart part = headerOf(frame.out);
  EXPECT_EQ(part.attributes.text("renderer"), "made up");
  const auto names = part.attributes.names();
  EXPECT_NE(std::find(names.begin(), names.end(), "cameraZoom"), names.end());
  EXPECT_TRUE(part.attributes.text("xrds:model").value_or("").starts_with("s4_guided.model "));
  EXPECT_EQ(part.attributes.text("xrds:options"), "precision=fp32 exposure=0.5");
  EXPECT_TRUE(part.attributes.text("xrds:version").has_value());
  EXPECT_EQ(part.layers.front().channels.front().type, ExrPixelType::kHalf);
}

TEST(CliFrame, ScalesOffsetWindowsAndOverscanExactly) {
  const SmallFrame frame;
  const Box low{-2, 3, 7, 10}, high{-8, 12, 31, 43};
  writeParts(frame.color, {{low, boxOf(6, 14), {colourLayer("", 10)}}});
  writeParts(frame.aux, {{high, boxOf(24, 56), {albedoLayer("albedo", 40), normalLayer("normal", 40)}}});
  const Ended ended = runXrds(frame.arguments());
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(headerOf(frame.out).dataWindow, high);
  EXPECT_EQ(headerOf(frame.out).displayWindow, boxOf(24, 56));
}

TEST(CliFrame, AnAuxiliaryImageOutsideOfTheFrameIsRefused) {
  const SmallFrame frame;
  const Box elsewhere{100, 0, 139, 31};
  writeParts(frame.aux, {{elsewhere, elsewhere, {albedoLayer("albedo", 40), normalLayer("normal", 40)}}});
  const Ended ended = runXrds(frame.arguments());
  EXPECT_EQ(ended.exitCode, 3) << ended.error;
  EXPECT_TRUE(contains(ended.error, "No pixel of layer 'albedo' lies in the frame")) << ended.error;
}

TEST(CliFrame, AnAuxiliaryCropIsPlacedAndReported) {
  const SmallFrame frame;
  writeParts(frame.aux, {{{4, 4, 39, 31}, boxOf(40, 32), {albedoLayer("albedo", 36), normalLayer("normal", 36)}}});
  const Ended ended = runXrds(frame.arguments());
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.error, "Layer 'albedo' covers 36 x 28 at (4, 4)")) << ended.error;
}

TEST(CliFrame, FindsAllLayersInOneFileOfSeveralParts) {
  const SmallFrame frame;
  const std::string all = (frame.folder / "all.exr").string();
  writeParts(all, {{boxOf(10, 8), boxOf(40, 32), {colourLayer("", 10)}, "beauty"},
                   {boxOf(40, 32), boxOf(40, 32), {albedoLayer("albedo", 40), normalLayer("normal", 40)}, "features"}});
  const Ended ended = runXrds({"upscale", all, "-o", frame.out, "--model", goldenModel("s4_guided")});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(headerOf(frame.out).dataWindow, boxOf(40, 32));
  EXPECT_EQ(headerOf(frame.out).displayWindow, boxOf(40, 32));
  ASSERT_EQ(runXrds(frame.arguments()).exitCode, 0);
  EXPECT_EQ(runXrds({"compare", frame.out, frame.out}).exitCode, 0);
}

TEST(CliFrame, TakesBlackAndWhiteAsGrey) {
  const SmallFrame frame;
  const auto upscaled = [&](const char* channels, const std::string& colourName) {
    const auto greyOf = [&](const Layer& layer) {
      return Layer{layer.name, channels, [pixels = layer.pixels](int x, int y, int) { return pixels(x, y, 1); }};
    };
    writeParts(frame.color, {{boxOf(10, 8), boxOf(10, 8), {greyOf(colourLayer(colourName, 10))}}});
    writeParts(frame.aux,
               {{boxOf(40, 32), boxOf(40, 32), {greyOf(albedoLayer("albedo", 40)), normalLayer("normal", 40)}}});
    const Ended ended = runXrds(frame.arguments());
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    return readColour(frame.out);
  };
  const Image expected = upscaled("RGB", "");
  EXPECT_EQ(upscaled("Y", ""), expected);
  EXPECT_EQ(upscaled("Y", "Main.Combined"), expected);
  const std::vector<ExrChannel> channels = headerOf(frame.out).layers.front().channels;
  ASSERT_EQ(channels.size(), 3U);
  EXPECT_EQ(channels.back().name, "R");
  const Ended same = runXrds({"compare", frame.color, frame.color, "--min-psnr", "90"});
  EXPECT_EQ(same.exitCode, 0) << same.error;
}

TEST(CliFrame, OneLayerFileOfScaleOne) {
  const SmallFrame frame;
  const std::string all = (frame.folder / "all.exr").string();
  writeParts(
      all, {{boxOf(10, 8), boxOf(10, 8), {colourLayer("", 10), albedoLayer("albedo", 10), normalLayer("normal", 10)}}});
  const Ended ended = runXrds({"upscale", all, "-o", frame.out, "--model", goldenModel("s1_guided")});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(headerOf(frame.out).dataWindow, boxOf(10, 8));
}

TEST(CliFrame, OutputMayReplaceAnInput) {
  const SmallFrame frame;
  ASSERT_EQ(runXrds(frame.arguments()).exitCode, 0);
  const Image expected = readColour(frame.out);
  for (const std::string& target : {frame.color, frame.aux}) {
    const SmallFrame again;
    const std::string replaced = target == frame.color ? again.color : again.aux;
    const Ended ended =
        runXrds({"upscale", again.color, again.aux, "-o", replaced, "--model", goldenModel("s4_guided")});
    ASSERT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_EQ(readColour(replaced).pixels, expected.pixels);
    EXPECT_EQ(again.folder.fileCount(), 2u);
  }
}

TEST(CliFrame, UpscalesAlphaAndKeepsOpaqueOpaque) {
  const SmallFrame frame;
  const Layer colour = colourLayer("", 10);
  const Layer withAlpha{"", "RGBA", [&](int x, int y, int c) {
                          return c < 3 ? colour.pixels(x, y, c) : x < 5 ? 1.F : 0.F;
                        }};
  writeParts(frame.color, {{boxOf(10, 8), boxOf(10, 8), {withAlpha}}});
  ASSERT_EQ(runXrds(frame.arguments()).exitCode, 0);
  const ExrFile file = readExrHeader(frame.out);
  const Image alpha = readLayer(file, {0, "", {"A"}});
  EXPECT_EQ(alpha.at(0, 16, 0), 1.F);
  EXPECT_EQ(alpha.at(39, 16, 0), 0.F);
  for (const float value : alpha.pixels) EXPECT_TRUE(value >= 0 && value <= 1);
}

// In a panorama the left edge is what stands right of the right edge, for alpha too.
TEST(CliFrame, WrapsAlphaWithTheColour) {
  const SmallFrame frame;
  const Layer colour = colourLayer("", 10);
  const Layer withAlpha{"", "RGBA", [&](int x, int y, int c) {
                          return c < 3 ? colour.pixels(x, y, c) : x < 5 ? 1.F : 0.F;
                        }};
  writeParts(frame.color, {{boxOf(10, 8), boxOf(10, 8), {withAlpha}}});
  ASSERT_EQ(runXrds(frame.arguments({"--wrap"})).exitCode, 0);
  const Image alpha = readLayer(readExrHeader(frame.out), {0, "", {"A"}});
  EXPECT_EQ(alpha.at(10, 16, 0), 1.F);
  EXPECT_EQ(alpha.at(29, 16, 0), 0.F);
  for (const auto& [x, opaque] : {std::pair{0, true}, {39, false}}) {
    const float value = alpha.at(x, 16, 0);
    EXPECT_TRUE(value > 0 && value < 1) << x;
    EXPECT_EQ(value > 0.5F, opaque) << x;
    // The edge in the middle of the frame has the same two sides.
    EXPECT_NEAR(value, alpha.at(opaque ? 19 : 20, 16, 0), 1e-5F) << x;
  }
}

TEST(CliFrame, RepairsCountsAndReportsWhatIsNotFinite) {
  const SmallFrame frame;
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  const Layer good = colourLayer("", 10), normal = normalLayer("normal", 40);
  writeParts(frame.color, {{boxOf(10, 8), boxOf(10, 8), {{"", "RGB", [&](int x, int y, int c) {
                                                            return x == 3 && y < 2    ? nan
                                                                   : x == 7 && y == 4 ? inf
                                                                   : x == 8 && y == 6 ? -1.F
                                                                                      : good.pixels(x, y, c);
                                                          }}}}});
  writeParts(frame.aux,
             {{boxOf(40, 32), boxOf(40, 32), {albedoLayer("albedo", 40), {"normal", "XYZ", [&](int x, int y, int c) {
                                                                            return x == 9 && y == 9
                                                                                       ? nan
                                                                                       : normal.pixels(x, y, c);
                                                                          }}}}});
  const Ended ended = runXrds(frame.arguments());
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.error, "3 pixels of layer '(unnamed)' not finite")) << ended.error;
  EXPECT_TRUE(contains(ended.error, "1 pixel of layer '(unnamed)' negative")) << ended.error;
  EXPECT_TRUE(contains(ended.error, "1 pixel of layer 'normal' not finite")) << ended.error;
  EXPECT_TRUE(allFinite(readColour(frame.out)));
}

TEST(CliFrame, ThatHasNoFinitePixelIsRefused) {
  const SmallFrame frame;
  writeParts(frame.color, {{boxOf(10, 8), boxOf(10, 8), {{"", "RGB", [](int, int, int) { return std::nanf(""); }}}}});
  const Ended ended = runXrds(frame.arguments());
  EXPECT_EQ(ended.exitCode, 3) << ended.error;
  EXPECT_TRUE(contains(ended.error, "No pixel of the colour '(unnamed)'")) << ended.error;
  EXPECT_FALSE(std::filesystem::exists(frame.out));
}

TEST(CliFrame, AModelWithoutAuxiliaryImagesNeedsNone) {
  const SmallFrame frame;
  const std::vector<std::string> rest{"-o", frame.out, "--model", goldenModel("s4_none_noaux")};
  const auto upscale = [&](std::vector<std::string> inputs) {
    inputs.insert(inputs.begin(), "upscale");
    inputs.insert(inputs.end(), rest.begin(), rest.end());
    return runXrds(inputs);
  };
  const Ended ended = upscale({frame.color});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(headerOf(frame.out).dataWindow, boxOf(40, 32));
  const Ended warned = upscale({frame.color, frame.aux});
  EXPECT_EQ(warned.exitCode, 0);
  EXPECT_TRUE(contains(warned.error, "takes no auxiliary images")) << warned.error;
}

TEST(CliFrame, ChecksProfilesAndShowsTheBaselines) {
  const SmallFrame frame;
  writeParts(frame.folder / "ref.exr", {{boxOf(40, 32), boxOf(40, 32), {colourLayer("", 40)}}});
  const Ended ended =
      runXrds(frame.arguments({"--check", "--profile", "--reference", (frame.folder / "ref.exr").string(),
                               "--side-by-side", (frame.folder / "s.png").string()}));
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  for (const char* expected : {"operators agree with the reference", "slowest dispatches", "\nbicubic ",
                               "\ndemodulated bicubic ", "\nguided ", "\nxrds "})
    EXPECT_TRUE(contains(ended.output, expected)) << expected << " in " << ended.output;
  EXPECT_EQ(frame.folder.fileCount(), 5u);
}

}  // namespace
}  // namespace xrds::test
