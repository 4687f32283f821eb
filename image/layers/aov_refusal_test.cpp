// What is said where the layer asked for is not there, or more than one could be it.
#include <gtest/gtest.h>

#include "image/layers/aov.h"
#include "image/layers/listed_files.h"

namespace xrds::test {
namespace {

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

// Mitsuba's mi.util.write_bitmap(path, mi.render(...)).
TEST(Aov, TellsHowToNameTheChannelsOfAnArray) {
  const ExrFile array = fileWith({partWith({"ch00", "ch01", "ch02", "ch03", "ch10"})});
  for (const AovRole role : {AovRole::kColor, AovRole::kAlbedo}) {
    const std::string message = refusal([&] { static_cast<void>(findAov(array, role)); });
    EXPECT_NE(message.find("film().bitmap()"), std::string::npos) << message;
    EXPECT_NE(message.find("ch03"), std::string::npos) << message;
  }
  for (const Names& names : {Names{"ch", "ch1"}, Names{"ch0", "chalk"}, Names{"V"}}) {
    const ExrFile other = fileWith({partWith(names)});
    const std::string message = refusal([&] { static_cast<void>(findAov(other, AovRole::kColor)); });
    EXPECT_EQ(message.find("film().bitmap()"), std::string::npos) << message;
  }
}

// LuxCore writes an unnamed R, G, B into a file for each image.
TEST(Aov, TellsThatFilesOfOneImageAreJoined) {
  const auto isToldOf = [](const ExrFile& file, AovRole role) {
    return refusal([&] { static_cast<void>(findAov(file, role)); }).find("join these") != std::string::npos;
  };
  const ExrFile one = fileWith({partWith(kRoot)});
  EXPECT_TRUE(isToldOf(one, AovRole::kAlbedo));
  EXPECT_TRUE(isToldOf(one, AovRole::kNormal));
  EXPECT_FALSE(isToldOf(fileWith({partWith({"V"})}), AovRole::kColor));
  EXPECT_FALSE(isToldOf(fileWith({partWith(kRoot + triple("diffuse", "RGB"))}), AovRole::kAlbedo));
}

}  // namespace
}  // namespace xrds::test
