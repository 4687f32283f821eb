#include "image/aov.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/print_case.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr Box kLow{0, 0, 63, 47};
constexpr Box kHigh{0, 0, 255, 191};

using Names = std::vector<std::string>;

// A part as a file's headers would list it; channels in alphabetical order as OpenEXR keeps them.
ExrPart partWith(Names channels, const Box& box = kLow, const std::string& name = "",
                 ExrPixelType type = ExrPixelType::kHalf) {
  std::sort(channels.begin(), channels.end());
  ExrPart part;
  part.name = name;
  part.dataWindow = box;
  part.displayWindow = box;
  for (const std::string& channel : channels) {
    const size_t dot = channel.rfind('.');
    const std::string layer = dot == std::string::npos ? "" : channel.substr(0, dot);
    const std::string suffix = dot == std::string::npos ? channel : channel.substr(dot + 1);
    auto found =
        std::find_if(part.layers.begin(), part.layers.end(), [&](const ExrLayer& l) { return l.name == layer; });
    if (found == part.layers.end()) {
      found = part.layers.insert(part.layers.end(), ExrLayer{layer, {}});
    }
    found->channels.push_back({channel, suffix, type, 1, 1});
  }
  return part;
}

ExrFile fileWith(std::vector<ExrPart> parts) {
  ExrFile file;
  file.path = "frame.exr";
  file.parts = std::move(parts);
  return file;
}

Names triple(const std::string& layer, const char* suffixes) {
  const std::string start = layer.empty() ? "" : layer + ".";
  return {start + suffixes[0], start + suffixes[1], start + suffixes[2]};
}

Names operator+(Names a, const Names& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

using test::PrintTo;

struct Renderer {
  const char* name;
  Names channels;
  Names color;
  Names alpha;
  Names albedo;
  Names normal;
};

const Names kRoot = triple("", "RGB");

class FindsLayersOf : public ::testing::TestWithParam<Renderer> {};

TEST_P(FindsLayersOf, Renderer) {
  const Renderer& renderer = GetParam();
  const ExrFile file = fileWith({partWith(renderer.channels)});
  const Aovs aovs = findAovs(file, file);
  EXPECT_EQ(aovs.color.channelNames, renderer.color);
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kAlbedo).channelNames, renderer.albedo);
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kNormal).channelNames, renderer.normal);
  EXPECT_EQ(aovs.alpha ? aovs.alpha->channelNames : Names{}, renderer.alpha);
}

const Names kCyclesAux = triple("ViewLayer.Denoising Albedo", "RGB") + triple("ViewLayer.Denoising Normal", "XYZ");
const Names kCycles = triple("ViewLayer.Combined", "RGB") + Names{"ViewLayer.Combined.A", "ViewLayer.Depth.Z"} +
                      kCyclesAux + triple("ViewLayer.CryptoObject00", "rgb") + triple("ViewLayer.Normal", "XYZ") +
                      triple("ViewLayer.DiffCol", "RGB") + Names{"ViewLayer.Denoising Depth.Z"};

INSTANTIATE_TEST_SUITE_P(
    Aov, FindsLayersOf,
    ::testing::Values(
        Renderer{"Cycles",
                 kCycles,
                 triple("ViewLayer.Combined", "RGB"),
                 {"ViewLayer.Combined.A"},
                 triple("ViewLayer.Denoising Albedo", "RGB"),
                 triple("ViewLayer.Denoising Normal", "XYZ")},
        Renderer{"CyclesDenoised",
                 kCycles + triple("ViewLayer.Noisy Image", "RGB"),
                 triple("ViewLayer.Noisy Image", "RGB"),
                 {"ViewLayer.Combined.A"},
                 triple("ViewLayer.Denoising Albedo", "RGB"),
                 triple("ViewLayer.Denoising Normal", "XYZ")},
        Renderer{"CyclesComposited",
                 kCycles + triple("Composite.Combined", "RGB"),
                 triple("ViewLayer.Combined", "RGB"),
                 {"ViewLayer.Combined.A"},
                 triple("ViewLayer.Denoising Albedo", "RGB"),
                 triple("ViewLayer.Denoising Normal", "XYZ")},
        Renderer{"Pbrt4",
                 kRoot + triple("Albedo", "RGB") + triple("N", "XYZ") + triple("Ns", "XYZ") + triple("P", "XYZ") +
                     triple("Variance", "RGB") + triple("RelativeVariance", "RGB") + Names{"u", "v", "dzdx", "dzdy"},
                 kRoot,
                 {},
                 triple("Albedo", "RGB"),
                 triple("Ns", "XYZ")},
        Renderer{"Pbrt4Before2023",
                 kRoot + triple("Albedo", "RGB") +
                     Names{"Nx", "Ny", "Nz", "Nsx", "Nsy", "Nsz", "Px", "Py", "Pz", "u", "v", "dzdx", "dzdy"},
                 kRoot,
                 {},
                 triple("Albedo", "RGB"),
                 {"Nsx", "Nsy", "Nsz"}},
        Renderer{"Mitsuba3",
                 kRoot + Names{"A", "image.A", "dd.y.T"} + triple("image", "RGB") + triple("albedo", "RGB") +
                     triple("sh_normal", "XYZ") + triple("nn", "XYZ"),
                 kRoot,
                 {"A"},
                 triple("albedo", "RGB"),
                 triple("sh_normal", "XYZ")},
        Renderer{"Mitsuba3NamedIntegrator",
                 triple("my_image", "RGB") + triple("albedo", "RGB") + triple("nn", "XYZ"),
                 triple("my_image", "RGB"),
                 {},
                 triple("albedo", "RGB"),
                 triple("nn", "XYZ")},
        Renderer{"Arnold",
                 kRoot + Names{"A", "Z"} + triple("denoise_albedo", "RGB") + triple("N", "XYZ") +
                     triple("diffuse", "RGB") + triple("diffuse_albedo", "RGB"),
                 kRoot,
                 {"A"},
                 triple("denoise_albedo", "RGB"),
                 triple("N", "XYZ")},
        Renderer{"ArnoldNoice",
                 triple("RGBA", "RGB") + triple("denoise_albedo_noice", "RGB") + triple("N_noice", "XYZ"),
                 triple("RGBA", "RGB"),
                 {},
                 triple("denoise_albedo_noice", "RGB"),
                 triple("N_noice", "XYZ")},
        Renderer{"RenderMan",
                 triple("Ci", "rgb") + Names{"Ci.a"} + triple("albedo", "rgb") + triple("albedo_mse", "rgb") +
                     triple("albedo_var", "rgb") + triple("normal", "rgb") + triple("normal_var", "rgb") +
                     triple("mse", "rgb"),
                 triple("Ci", "rgb"),
                 {"Ci.a"},
                 triple("albedo", "rgb"),
                 triple("normal", "rgb")},
        Renderer{"LuxCore",
                 triple("ViewLayer.Combined", "RGB") + triple("ViewLayer.ALBEDO", "RGB") +
                     triple("ViewLayer.AVG_SHADING_NORMAL", "XYZ") + triple("ViewLayer.SHADING_NORMAL", "XYZ"),
                 triple("ViewLayer.Combined", "RGB"),
                 {},
                 triple("ViewLayer.ALBEDO", "RGB"),
                 triple("ViewLayer.AVG_SHADING_NORMAL", "XYZ")},
        Renderer{"Karma",
                 triple("C", "rgb") + triple("albedo", "rgb") + triple("N", "xyz"),
                 triple("C", "rgb"),
                 {},
                 triple("albedo", "rgb"),
                 triple("N", "xyz")},
        Renderer{"Redshift",
                 kRoot + Names{"A", "Z"} + triple("DiffuseFilter", "RGB") + triple("DiffuseLighting", "RGB") +
                     triple("GI", "RGB") + triple("Normals", "RGB") + triple("BumpNormals", "RGB"),
                 kRoot,
                 {"A"},
                 triple("DiffuseFilter", "RGB"),
                 triple("BumpNormals", "RGB")},
        Renderer{"VRay",
                 kRoot + Names{"A"} + triple("VRayDiffuseFilter", "RGB") + triple("VRayLighting", "RGB") +
                     triple("VRayNormals", "XYZ"),
                 kRoot,
                 {"A"},
                 triple("VRayDiffuseFilter", "RGB"),
                 triple("VRayNormals", "XYZ")},
        Renderer{"PlainWords",
                 triple("Beauty", "RGB") + triple("base-color", "BRG") + triple("NORMALS", "ZYX"),
                 triple("Beauty", "RGB"),
                 {},
                 triple("base-color", "RGB"),
                 triple("NORMALS", "XYZ")}),
    [](const auto& renderer) { return renderer.param.name; });

// The message of the Error that `find` must throw.
template <typename Find>
std::string refusal(Find&& find) {
  try {
    find();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

TEST(Aov, TakesTheRenderBeforeDenoisingAndSaysSo) {
  const ExrFile file = fileWith({partWith(kCycles + triple("ViewLayer.Noisy Image", "RGB"))});
  const Aovs aovs = findAovs(file, file);
  ASSERT_EQ(aovs.notes.size(), 1U);
  EXPECT_NE(aovs.notes[0].find("before denoising"), std::string::npos);
  EXPECT_EQ(findAov(file, AovRole::kColor, "Combined").channelNames, triple("ViewLayer.Combined", "RGB"));
}

TEST(Aov, SeparateFilesNeedNoDecision) {
  const ExrFile low = fileWith({partWith(kCycles)});
  const ExrFile high = fileWith({partWith(kCycles, kHigh)});
  const Aovs aovs = findAovs(low, high);
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kAlbedo).channelNames, triple("ViewLayer.Denoising Albedo", "RGB"));
  EXPECT_TRUE(aovs.notes.empty());
}

TEST(Aov, OneFileWithPartsOfTwoSizes) {
  const ExrFile file = fileWith({partWith(kCycles, kHigh, "high"), partWith(kCycles, kLow, "low")});
  const Aovs aovs = findAovs(file, file);
  EXPECT_EQ(aovs.color.part, 1U);
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kAlbedo).part, 0U);
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kNormal).part, 0U);
}

TEST(Aov, PartNamesWithoutMeaningAreNoNames) {
  const Names aux = triple("albedo", "RGB") + triple("nn", "XYZ");
  for (const Names& low : {kRoot, kRoot + triple("my_image", "RGB") + aux}) {
    const ExrFile file = fileWith({partWith(low, kLow, "low"), partWith(kRoot + aux, kHigh, "high")});
    const Aovs aovs = findAovs(file, file);
    EXPECT_EQ(aovs.color, (ExrSelection{0, aovs.color.layer, kRoot}));
    EXPECT_EQ(aovs.auxiliary.at(AovRole::kAlbedo).part, 1U);
    EXPECT_EQ(aovs.auxiliary.at(AovRole::kNormal).part, 1U);
  }
}

// Since version 5 Blender writes each pass, and each of its views, into a part of its own.
TEST(Aov, OnePartForEachPassAndView) {
  std::vector<ExrPart> parts;
  for (const char* pass : {"Combined", "Noisy Image", "Denoising Albedo", "Denoising Normal"}) {
    for (const char* view : {"left", "right"}) {
      const std::string layer = std::string("ViewLayer.") + pass;
      const bool isNormal = layer.ends_with("Normal");
      parts.push_back(partWith(triple(layer, isNormal ? "XYZ" : "RGB"), kLow, layer + "-" + view));
      parts.back().view = view;
    }
  }
  const ExrFile file = fileWith(parts);
  const Aovs aovs = findAovs(file, file);
  EXPECT_EQ(aovs.color.part, 2U);
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kAlbedo).part, 4U);
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kNormal).part, 6U);
  EXPECT_EQ(findAov(file, AovRole::kColor, "ViewLayer.Noisy Image-right").part, 3U);
  EXPECT_EQ(findAov(file, AovRole::kColor, "Combined").part, 0U);
}

TEST(Aov, FindsDepthAmongLayersOfOneChannel) {
  const auto depthOf = [](const Names& channels, const std::string& name = "") {
    return findAov(fileWith({partWith(channels)}), AovRole::kDepth, name).channelNames;
  };
  EXPECT_EQ(depthOf(kCycles), Names{"ViewLayer.Denoising Depth.Z"});
  EXPECT_EQ(depthOf(kCycles, "Depth"), Names{"ViewLayer.Depth.Z"});
  EXPECT_EQ(depthOf(kRoot + Names{"A", "Z"}), Names{"Z"});
  EXPECT_EQ(depthOf(kRoot + Names{"depth.V", "mist.V"}), Names{"depth.V"});
  EXPECT_EQ(depthOf(kRoot + Names{"mist.V"}, "mist"), Names{"mist.V"});
  EXPECT_NE(refusal([&] { depthOf(kRoot + triple("N", "XYZ") + Names{"mist.V"}); }).find("No depth"),
            std::string::npos);
}

TEST(Aov, FindsBothLightsOfCycles) {
  const std::string layers[][4] = {{"DiffDir", "DiffInd", "GlossDir", "GlossInd"},
                                   {"Diffuse Direct", "Diffuse Indirect", "Glossy Direct", "Glossy Indirect"}};
  for (const auto& [diffuse, diffuseMore, glossy, glossyMore] : layers) {
    const auto layer = [](const std::string& name) { return triple("ViewLayer." + name, "RGB"); };
    const ExrFile file =
        fileWith({partWith(kCycles + layer(diffuse) + layer(diffuseMore) + layer(glossy) + layer(glossyMore))});
    const ExrSelection direct = findAov(file, AovRole::kDiffuse);
    EXPECT_EQ(direct.channelNames, layer(diffuse));
    EXPECT_EQ(indirectLight(file, AovRole::kDiffuse, direct)->channelNames, layer(diffuseMore));
    EXPECT_EQ(indirectLight(file, AovRole::kGlossy, findAov(file, AovRole::kGlossy))->channelNames, layer(glossyMore));
    EXPECT_EQ(findAov(file, AovRole::kColor).channelNames, triple("ViewLayer.Combined", "RGB"));
  }
}

TEST(Aov, TakesLightOfOtherNamesOnlyIfNamed) {
  const ExrFile arnold =
      fileWith({partWith(kRoot + triple("diffuse_direct", "RGB") + triple("diffuse_indirect", "RGB"))});
  EXPECT_FALSE(hasAov(arnold, AovRole::kDiffuse));  // it holds the albedo
  const ExrSelection named = findAov(arnold, AovRole::kDiffuse, "diffuse_direct");
  EXPECT_FALSE(indirectLight(arnold, AovRole::kDiffuse, named));
  const ExrFile half = fileWith({partWith(kCycles + triple("ViewLayer.DiffDir", "RGB"))});
  const ExrSelection direct = findAov(half, AovRole::kDiffuse);
  try {
    indirectLight(half, AovRole::kDiffuse, direct);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("expected 'DiffInd' beside 'ViewLayer.DiffDir'"), std::string::npos)
        << error.what();
  }
}

TEST(Aov, DepthIsLookedForWhereItIsNeeded) {
  const ExrFile file = fileWith({partWith(kCycles)});
  EXPECT_FALSE(findAovs(file, file).auxiliary.contains(AovRole::kDepth));
  EXPECT_EQ(findAovs(file, file, {.needed = {AovRole::kDepth}}).auxiliary.at(AovRole::kDepth).channelNames,
            Names{"ViewLayer.Denoising Depth.Z"});
}

TEST(Aov, PartNamesNameUnnamedLayers) {
  const ExrFile file = fileWith({partWith(kRoot, kHigh, "diffuse"), partWith(kRoot, kHigh, "N"),
                                 partWith(kRoot, kHigh, "denoise_albedo"), partWith(kRoot + Names{"A"}, kLow, "RGBA")});
  const Aovs aovs = findAovs(file, file);
  EXPECT_EQ(aovs.color.part, 3U);
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kAlbedo).part, 2U);
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kNormal).part, 1U);
  EXPECT_EQ(findAov(file, AovRole::kColor, "diffuse").part, 0U);
}

TEST(Aov, TakesTheOnlyLayerLeftForColor) {
  const ExrFile file = fileWith({partWith(kRoot, kLow, "low"), partWith(triple("albedo", "RGB"), kHigh, "high"),
                                 partWith(triple("CryptoObject00", "rgb"), kHigh, "crypto")});
  const Aovs aovs = findAovs(file, file, {.needed = {AovRole::kAlbedo}});
  EXPECT_EQ(aovs.color.part, 0U);
  EXPECT_FALSE(aovs.auxiliary.contains(AovRole::kNormal));
  EXPECT_TRUE(aovs.notes.empty());
  const ExrFile named = fileWith({partWith(triple("my_image", "RGB") + triple("albedo", "RGB"))});
  EXPECT_EQ(findAovs(named, named, {.needed = {AovRole::kAlbedo}}).notes.size(), 1U);
}

TEST(Aov, OtherViewsAreLeftAlone) {
  ExrFile file =
      fileWith({partWith(triple("L.Combined.left", "RGB") + triple("L.Combined.right", "RGB") +
                         triple("L.Denoising Albedo.left", "RGB") + triple("L.Denoising Albedo.right", "RGB"))});
  file.views = {"left", "right"};
  const AovRequest request{.needed = {AovRole::kAlbedo}};
  const Aovs aovs = findAovs(file, file, request);
  EXPECT_EQ(aovs.color.channelNames, triple("L.Combined.left", "RGB"));
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kAlbedo).channelNames, triple("L.Denoising Albedo.left", "RGB"));
  EXPECT_EQ(aovs.notes.size(), 1U);
  EXPECT_EQ(findAov(file, AovRole::kColor, "L.Combined.right").channelNames, triple("L.Combined.right", "RGB"));

  ExrFile parts = fileWith({partWith(kRoot, kLow, "rgba.left"), partWith(kRoot, kLow, "rgba.right")});
  parts.parts[0].view = "left";
  parts.parts[1].view = "right";
  parts.views = {"left", "right"};
  EXPECT_EQ(findAov(parts, AovRole::kColor).part, 0U);
}

TEST(Aov, FullColorIsThatOfTheLargestPart) {
  const ExrFile file = fileWith({partWith(kCycles, kLow, "low"), partWith(kCycles, kHigh, "high")});
  EXPECT_EQ(findAov(file, AovRole::kColor).part, 0U);
  EXPECT_EQ(findAov(file, AovRole::kFullColor).part, 1U);
  EXPECT_EQ(findAov(file, AovRole::kFullColor).channelNames, findAov(file, AovRole::kColor).channelNames);
  EXPECT_FALSE(hasAov(fileWith({partWith(triple("albedo", "RGB"))}), AovRole::kFullColor));
}

// Guides that were rendered without a beauty.
TEST(Aov, PassesOfLightAreNoFullColor) {
  for (const char* name : {"DiffCol", "L.Diffuse Color", "L.GlossDir", "Emit", "L.Combined_key"}) {
    const ExrFile file = fileWith({partWith(kCyclesAux + triple(name, "RGB"))});
    EXPECT_FALSE(hasAov(file, AovRole::kFullColor)) << name;
    EXPECT_EQ(findAov(file, AovRole::kFullColor, name).channelNames, triple(name, "RGB"));
  }
  EXPECT_FALSE(hasAov(fileWith({partWith(kCyclesAux + triple("DiffCol", "RGB"))}), AovRole::kColor));
  EXPECT_TRUE(hasAov(fileWith({partWith(kCyclesAux + triple("DiffDir", "RGB"))}), AovRole::kColor));
}

TEST(Aov, SaysWhichChannelsALayerLacks) {
  const ExrFile file = fileWith({partWith(triple("", "RGB") + triple("Position", "XYZ"))});
  const std::string message = refusal([&] { static_cast<void>(findAov(file, AovRole::kColor, "Position")); });
  EXPECT_NE(message.find("a layer 'Position' with floating-point channels R, G, B"), std::string::npos) << message;
}

TEST(Aov, TwoViewLayersAreAmbiguous) {
  const Names both = kCycles + triple("Hero.Combined", "RGB") + triple("Hero.Denoising Albedo", "RGB") +
                     triple("Hero.Denoising Normal", "XYZ");
  const ExrFile file = fileWith({partWith(both)});
  const std::string message = refusal([&] { static_cast<void>(findAovs(file, file)); });
  EXPECT_NE(message.find("ambiguous"), std::string::npos) << message;
  EXPECT_NE(message.find("0:ViewLayer.Combined"), std::string::npos) << message;
  EXPECT_NE(message.find("0:Hero.Combined"), std::string::npos) << message;
  EXPECT_NE(message.find("--color"), std::string::npos) << message;
  EXPECT_NE(message.find("Denoising Depth"), std::string::npos) << message;

  const std::string ofCompare = refusal([&] { static_cast<void>(findAov(file, AovRole::kColor, "", "--layer")); });
  EXPECT_NE(ofCompare.find("name the one to use with --layer LAYER"), std::string::npos) << ofCompare;
  const std::string ofNone = refusal([&] { static_cast<void>(findAov(file, AovRole::kColor, "", "")); });
  EXPECT_NE(ofNone.find("take a file with one such layer"), std::string::npos) << ofNone;

  const Aovs aovs = findAovs(file, file, {.names = {{AovRole::kColor, "Hero.Combined"}}});
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kAlbedo).channelNames, triple("Hero.Denoising Albedo", "RGB"));
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kNormal).channelNames, triple("Hero.Denoising Normal", "XYZ"));

  const ExrFile oneDenoised = fileWith({partWith(both + triple("Hero.Noisy Image", "RGB"))});
  EXPECT_NE(refusal([&] { static_cast<void>(findAovs(oneDenoised, oneDenoised)); }).find("ambiguous"),
            std::string::npos);
}

TEST(Aov, AbsenceListsWhatThereIs) {
  const ExrFile file = fileWith({partWith(kRoot + triple("diffuse", "RGB"))});
  const std::string message = refusal([&] { static_cast<void>(findAovs(file, file)); });
  EXPECT_NE(message.find("No albedo"), std::string::npos) << message;
  EXPECT_NE(message.find("--albedo"), std::string::npos) << message;
  EXPECT_NE(message.find("diffuse [B G R]"), std::string::npos) << message;
  EXPECT_NO_THROW(static_cast<void>(findAovs(file, file, {.needed = {}})));
  EXPECT_NO_THROW(static_cast<void>(
      findAovs(file, file, {.names = {{AovRole::kAlbedo, "diffuse"}}, .needed = {AovRole::kAlbedo}})));
}

TEST(Aov, NamesGoThroughEveryReading) {
  const ExrFile file = fileWith({partWith(kRoot, kLow, "main"), partWith(triple("A.Tint", "rgb"), kHigh, "second"),
                                 partWith(triple("A.Tint", "rgb"), kHigh, "third")});
  EXPECT_EQ(findAov(file, AovRole::kAlbedo, "1:A.Tint").part, 1U);
  EXPECT_EQ(findAov(file, AovRole::kAlbedo, "2:tint").part, 2U);
  EXPECT_EQ(findAov(file, AovRole::kAlbedo, "third").part, 2U);
  EXPECT_EQ(findAov(file, AovRole::kColor, "RGB").part, 0U);
  EXPECT_EQ(findAov(file, AovRole::kColor, "0:").part, 0U);
  EXPECT_EQ(findAov(file, AovRole::kColor, "(unnamed)").part, 0U);
  EXPECT_NE(refusal([&] { static_cast<void>(findAov(file, AovRole::kAlbedo, "a.tint")); }).find("ambiguous"),
            std::string::npos);
  EXPECT_NE(refusal([&] { static_cast<void>(findAov(file, AovRole::kAlbedo, "9:tint")); }).find("No albedo"),
            std::string::npos);
}

TEST(Aov, IgnoresWholeNumbersSubsampledAndDeep) {
  ExrPart deep = partWith(kRoot);
  deep.deep = true;
  ExrPart chroma = partWith(kRoot);
  chroma.layers[0].channels[1].xSampling = 2;
  for (const ExrPart& part : {partWith(kRoot, kLow, "", ExrPixelType::kUint), deep, chroma, partWith({"V"})}) {
    const ExrFile file = fileWith({part});
    EXPECT_NE(refusal([&] { static_cast<void>(findAov(file, AovRole::kColor)); }).find("No colour"), std::string::npos);
  }
  const ExrFile mixed = fileWith({deep, partWith(kRoot, kHigh)});
  EXPECT_EQ(findAov(mixed, AovRole::kColor).part, 1U);
}

TEST(Aov, GivesNoHintThatWouldFail) {
  ExrPart deep = partWith(kRoot);
  deep.deep = true;
  const std::string ofDeep = refusal([&] { static_cast<void>(findAov(fileWith({deep}), AovRole::kColor)); });
  EXPECT_NE(ofDeep.find("found deep samples; flatten it first"), std::string::npos) << ofDeep;
  EXPECT_EQ(ofDeep.find("--color"), std::string::npos) << ofDeep;
  const std::string ofMask = refusal([&] { static_cast<void>(findAov(fileWith({partWith({"V"})}), AovRole::kColor)); });
  EXPECT_EQ(ofMask.find("--color"), std::string::npos) << ofMask;
  EXPECT_NE(ofMask.find("render it with this layer"), std::string::npos) << ofMask;
  const std::string ofColour =
      refusal([&] { static_cast<void>(findAov(fileWith({partWith(kRoot)}), AovRole::kAlbedo)); });
  EXPECT_NE(ofColour.find("--albedo LAYER"), std::string::npos) << ofColour;
}

}  // namespace
}  // namespace xrds
