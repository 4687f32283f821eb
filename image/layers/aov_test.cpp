#include "image/layers/aov.h"

#include <gtest/gtest.h>

#include "image/layers/listed_files.h"
#include "tests/print_case.h"

namespace xrds::test {
namespace {

struct Renderer {
  const char* name;
  Names channels;
  Names color;
  Names alpha;
  Names albedo;
  Names normal;
};

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
        Renderer{"Mitsuba3FilmBitmap",  // 3.9: hdrfilm of rgb, aovs "albedo:albedo,nn:sh_normal,dd:depth"
                 kRoot + triple("img", "RGB") + Names{"img.A", "dd.T"} + triple("albedo", "RGB") + triple("nn", "XYZ"),
                 kRoot,
                 {},
                 triple("albedo", "RGB"),
                 triple("nn", "XYZ")},
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
  EXPECT_EQ(depthOf(kRoot + triple("nn", "XYZ") + Names{"dd.T"}), Names{"dd.T"});
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

TEST(Aov, WhatBelongsToAColourIsOfItsView) {
  const auto both = [](const std::string& layer, const char* suffixes) {
    return triple(layer + ".left", suffixes) + triple(layer + ".right", suffixes);
  };
  ExrFile file = fileWith(
      {partWith(both("L.Combined", "RGB") + both("L.Denoising Albedo", "RGB") + triple("L.Denoising Normal", "XYZ") +
                Names{"L.Depth.left.Z", "L.Depth.right.Z"} + Names{"L.Combined.left.A", "L.Combined.right.A"})});
  file.views = {"left", "right"};
  const Aovs aovs = findAovs(file, file, {.names = {{AovRole::kColor, "L.Combined.right"}}});
  EXPECT_EQ(aovs.alpha->channelNames, Names{"L.Combined.right.A"});
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kAlbedo).channelNames, triple("L.Denoising Albedo.right", "RGB"));
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kNormal).channelNames, triple("L.Denoising Normal", "XYZ"));  // of no view
  EXPECT_EQ(findAov(file, AovRole::kFullColor, "", aovs.place).channelNames, triple("L.Combined.right", "RGB"));
  EXPECT_EQ(findAov(file, AovRole::kDepth, "Depth", aovs.place).channelNames, Names{"L.Depth.right.Z"});
  const ExrFile one = fileWith({partWith(kCyclesAux)});  // a file for each eye
  EXPECT_EQ(findAov(one, AovRole::kAlbedo, "", aovs.place).channelNames, triple("ViewLayer.Denoising Albedo", "RGB"));
}

// Their channels are right.R and so on.
TEST(Aov, TheUnnamedLayerOfAViewGoesByTheName) {
  ExrFile file = fileWith({partWith(kRoot + triple("right", "RGB") + triple("albedo.right", "RGB"))});
  file.views = {"left", "right"};
  const AovRequest request{.names = {{AovRole::kColor, "right"}}, .needed = {AovRole::kAlbedo}};
  const Aovs aovs = findAovs(file, file, request);
  EXPECT_EQ(aovs.color.channelNames, triple("right", "RGB"));
  EXPECT_EQ(aovs.auxiliary.at(AovRole::kAlbedo).channelNames, triple("albedo.right", "RGB"));
  const Aovs other = findAovs(file, file, {.names = {}, .needed = {}});
  EXPECT_EQ(other.color.channelNames, kRoot);
  ASSERT_EQ(other.notes.size(), 1U);
  EXPECT_NE(other.notes[0].find("'--color right' takes another"), std::string::npos) << other.notes[0];
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

}  // namespace
}  // namespace xrds::test
