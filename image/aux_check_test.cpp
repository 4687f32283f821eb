#include "image/aux_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "image/edge_check.h"

namespace xrds {
namespace {

// The normals of a ball in front of a background whose normal is 0.
Image ballNormals(int size) {
  Image image(size, size, 3);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float u = 2.2F * (static_cast<float>(x) + 0.5F) / static_cast<float>(size) - 1.1F;
      const float v = 2.2F * (static_cast<float>(y) + 0.5F) / static_cast<float>(size) - 1.1F;
      if (u * u + v * v < 1.0F) {
        image.at(x, y, 0) = u;
        image.at(x, y, 1) = v;
        image.at(x, y, 2) = std::sqrt(1.0F - u * u - v * v);
      }
    }
  }
  return image;
}

Image encoded(Image image) {
  for (float& value : image.pixels) {
    value = value * 0.5F + 0.5F;
  }
  return image;
}

// Two colours side by side, the step at column `edge`.
Image step(int width, int height, int edge, float left, float right) {
  Image image(width, height, 3, left);
  for (int y = 0; y < height; ++y) {
    for (int i = edge * 3; i < width * 3; ++i) {
      image.pixels[size_t(y * width * 3 + i)] = right;
    }
  }
  return image;
}

TEST(AuxCheck, CountsWhatIsThere) {
  Image image(2, 2, 2);
  image.pixels = {0, 0, 1, -3, std::numeric_limits<float>::quiet_NaN(), 2, 4, 0};
  const LayerStatistics statistics = statisticsOf(image);
  EXPECT_EQ(statistics.minimum, -3.0);
  EXPECT_EQ(statistics.maximum, 4.0);
  EXPECT_NEAR(statistics.mean, 4.0 / 7.0, 1e-12);
  EXPECT_EQ(statistics.nonFiniteCount, 1U);
  EXPECT_EQ(statistics.zeroPixelShare, 0.25);
  EXPECT_EQ(toString(statistics), "minimum -3, maximum 4, mean 0.571, 25 % of the pixels black, 1 values not finite");
  EXPECT_EQ(statisticsOf(Image()).maximum, 0.0);
}

TEST(AuxCheck, AcceptsGoodLayers) {
  const Image normal = ballNormals(40);
  const Image albedo = step(40, 40, 13, 0.2F, 1.0F);
  EXPECT_TRUE(checkNormal({"N", &normal}).empty());
  EXPECT_TRUE(checkAlbedo({"albedo", &albedo}).empty());
}

TEST(AuxCheck, RecognizesEncodedNormals) {
  const Image normal = encoded(ballNormals(40));
  EXPECT_TRUE(looksEncoded(normal));
  const std::vector<std::string> warnings = checkNormal({"my normals", &normal});
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("my normals"), std::string::npos);
  EXPECT_NE(warnings[0].find("n / 2 + 1 / 2"), std::string::npos);
  EXPECT_NE(warnings[0].find("minimum"), std::string::npos);
}

// A product before an empty background: most pixels are the grey that stands for no normal.
TEST(AuxCheck, RecognizesEncodedNormalsBeforeABackground) {
  const Image ball = encoded(ballNormals(10));
  Image normal(40, 40, 3, 0.5F);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x)
      for (int c = 0; c < 3; ++c) normal.at(x, y, c) = ball.at(x, y, c);
  EXPECT_TRUE(looksEncoded(normal));
  EXPECT_FALSE(looksEncoded(Image(8, 8, 3, 0.5F)));
}

TEST(AuxCheck, NormalsThatHappenToBePositiveAreNotEncoded) {
  Image octant(16, 16, 3, 1.0F / std::sqrt(3.0F));
  octant.at(3, 3, 0) = 1.0F;
  octant.at(3, 3, 1) = octant.at(3, 3, 2) = 0.0F;
  EXPECT_FALSE(looksEncoded(octant));
  EXPECT_FALSE(looksEncoded(Image(4, 4, 3)));
  EXPECT_FALSE(looksEncoded(Image()));
}

TEST(AuxCheck, WarnsOfBadAlbedo) {
  const Image black(8, 8, 3);
  const Image grey(8, 8, 3, 0.5F);
  const Image lit = step(8, 8, 4, 0.1F, 7.0F);
  const Image negative = step(8, 8, 4, -0.1F, 0.7F);
  EXPECT_NE(checkAlbedo({"a", &black}).at(0).find("nothing but zeros"), std::string::npos);
  EXPECT_NE(checkAlbedo({"a", &grey}).at(0).find("one value everywhere"), std::string::npos);
  EXPECT_NE(checkAlbedo({"a", &lit}).at(0).find("above 1 in 50 %"), std::string::npos);
  EXPECT_NE(checkAlbedo({"a", &negative}).at(0).find("negative"), std::string::npos);
}

// Cycles gives the background its radiance as albedo, and no normal.
TEST(AuxCheck, TakesTheRadianceOfTheBackgroundForNoLitAlbedo) {
  const Image normal = ballNormals(40);
  Image background(40, 40, 3);
  Image lit(40, 40, 3);
  for (size_t i = 0; i < normal.pixels.size(); ++i) {
    const size_t z = i - i % 3 + 2;
    const bool surface = normal.pixels[z] > 0.0F;
    const float tone = 0.2F + 0.01F * static_cast<float>(i % 7);
    background.pixels[i] = surface ? tone : 30.0F;
    lit.pixels[i] = surface ? 10.0F * tone : 0.5F;
  }
  EXPECT_TRUE(checkAlbedo({"a", &background}, &normal).empty());
  EXPECT_NE(checkAlbedo({"a", &background}).at(0).find("of the pixels, while"), std::string::npos);
  EXPECT_NE(checkAlbedo({"a", &lit}, &normal).at(0).find("above 1 in 100 % of the pixels with a surface"),
            std::string::npos);
}

TEST(AuxCheck, WarnsOfBadNormals) {
  const Image black(8, 8, 3);
  const Image positions = step(8, 8, 4, -20.0F, 7.0F);
  EXPECT_NE(checkNormal({"N", &black}).at(0).find("nothing but zeros"), std::string::npos);
  EXPECT_NE(checkNormal({"N", &positions}).at(0).find("beyond [-1, 1]"), std::string::npos);
}

TEST(AuxCheck, WarnsOfDepthThatTellsNothing) {
  const Image blank(8, 8, 1, 0), even(8, 8, 1, 5);
  Image sloping = even;
  sloping.pixels[3] = 6;
  EXPECT_NE(checkDepth({"Z", &blank}).at(0).find("nothing but zeros"), std::string::npos);
  EXPECT_NE(checkDepth({"Z", &even}).at(0).find("one value everywhere"), std::string::npos);
  EXPECT_TRUE(checkDepth({"Z", &sloping}).empty());
}

TEST(EdgeCheck, AcceptsSharedEdgesAndFlatColor) {
  const Image color = step(32, 24, 11, 0.1F, 0.9F);
  const Image albedo = step(128, 96, 44, 0.2F, 0.6F);
  const Image blank(128, 96, 3, 0.5F);
  EXPECT_TRUE(checkEdges(color, {{"albedo", &albedo}, {"N", &blank}}).empty());
  EXPECT_TRUE(checkEdges(Image(32, 24, 3, 0.4F), {{"N", &blank}}).empty());
  EXPECT_TRUE(checkEdges(Image(), {}).empty());
}

TEST(EdgeCheck, WarnsWhenLayersAreBlankOrOfAnotherFrame) {
  const Image color = step(32, 24, 11, 0.1F, 0.9F);
  const Image blank(128, 96, 3, 0.5F);
  const Image elsewhere = step(128, 96, 100, 0.2F, 0.6F);
  EXPECT_EQ(checkEdges(color, {{"N", &blank}}).size(), 1U);
  const std::vector<std::string> warnings = checkEdges(color, {{"albedo", &elsewhere}, {"N", &blank}});
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("'albedo' and 'N'"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("shadows"), std::string::npos) << warnings[0];  // of which it may be wrong
}

TEST(EdgeCheck, LayersOfForeignSizeAreSkipped) {
  const Image color = step(32, 24, 11, 0.1F, 0.9F);
  const Image odd(100, 77, 3, 0.5F);
  EXPECT_TRUE(checkEdges(color, {{"N", &odd}}).empty());
}

}  // namespace
}  // namespace xrds
