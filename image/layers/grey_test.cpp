// Layers of black and white, whose one channel Y stands for red, green and blue.
#include <gtest/gtest.h>

#include "image/layers/aov.h"
#include "image/test_files.h"
#include "tests/temporary_folder.h"
#include "xrds/error.h"

namespace xrds::test {
namespace {

using Names = std::vector<std::string>;

class GreyLayers : public testing::Test {
 protected:
  ExrFile fileOf(const Names& channels) const {
    writeFixture(folder_ / "grey.exr", {{"", kWindow, kWindow, channels}});
    return readExrHeader(folder_ / "grey.exr");
  }
  Names found(const Names& channels, AovRole role, const std::string& name = "") const {
    return findAov(fileOf(channels), role, name).channelNames;
  }
  std::string refusal(const Names& channels, AovRole role) const {
    try {
      static_cast<void>(found(channels, role));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  static constexpr Box kWindow{2, 3, 12, 9};
  const TemporaryFolder folder_;
};

TEST_F(GreyLayers, AreReadAsColour) {
  const ExrFile file = fileOf({"A", "Y", "Z"});
  const Aovs aovs = findAovs(file, file, {.names = {}, .needed = {}});
  EXPECT_EQ(aovs.color.channelNames, (Names{"Y", "Y", "Y"}));
  EXPECT_EQ(aovs.alpha.value().channelNames, Names{"A"});
  const Image image = readLayer(file, aovs.color);
  ASSERT_EQ(image.channels, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) ASSERT_EQ(image.at(x, y, c), fixtureValue(kWindow.minX + x, kWindow.minY + y, 1));
  EXPECT_EQ(findAov(file, AovRole::kDepth).channelNames, Names{"Z"});
}

TEST_F(GreyLayers, ServeAsColourAndAlbedoByTheirNames) {
  const Names channels{"RenderLayer.Combined.Y", "albedo.Y", "N.X", "N.Y", "N.Z"};
  EXPECT_EQ(found(channels, AovRole::kColor).front(), "RenderLayer.Combined.Y");
  EXPECT_EQ(found(channels, AovRole::kFullColor).front(), "RenderLayer.Combined.Y");
  EXPECT_EQ(found(channels, AovRole::kAlbedo), (Names{"albedo.Y", "albedo.Y", "albedo.Y"}));
  EXPECT_EQ(found(channels, AovRole::kNormal), (Names{"N.X", "N.Y", "N.Z"}));
  EXPECT_EQ(found({"mask.Y"}, AovRole::kColor, "mask").front(), "mask.Y");
}

TEST_F(GreyLayers, StandBehindColours) {
  EXPECT_EQ(found({"Y", "color.R", "color.G", "color.B"}, AovRole::kColor).front(), "color.R");
  EXPECT_EQ(found({"mask.Y", "some.R", "some.G", "some.B"}, AovRole::kColor).front(), "some.R");
  EXPECT_EQ(found({"R", "G", "B", "Y"}, AovRole::kColor).front(), "R");
}

TEST_F(GreyLayers, AreNoPartsOfOtherLayers) {
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "found none", refusal({"uv.X", "uv.Y"}, AovRole::kColor));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "--color LAYER", refusal({"mask.Y"}, AovRole::kColor));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "found none", refusal({"normal.Y"}, AovRole::kNormal));
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "found luminance and chroma, Y with RY and BY; save it as RGB.",
                      refusal({"Y", "RY", "BY"}, AovRole::kColor));
}

}  // namespace
}  // namespace xrds::test
