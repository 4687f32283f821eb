#include "advice/ways.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/temporary_folder.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr const char* kWays = R"({"ways": [{
  "name": "x4-full, merged", "model": "xrds-x4-full", "scale": 4, "guides": "rendered", "merges": true,
  "denoisesFirst": false, "takesFullColour": true, "ratios": [4, 16], "noise": [-12, -5], "spread": 0.9,
  "coefficients": {"constant": 10, "noise": -2, "detail": -0.5, "guideNoise": -0.25}}]})";

std::vector<Way> read(const std::string& text) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "ways.json") << text;
  return readWays(folder / "ways.json");
}

TEST(Ways, AreReadWithAllTheirFields) {
  const std::vector<Way> ways = read(kWays);
  ASSERT_EQ(ways.size(), 1U);
  const Way& way = ways.front();
  EXPECT_EQ(way.name, "x4-full, merged");
  EXPECT_EQ(way.model, "xrds-x4-full");
  EXPECT_EQ(way.scale, 4);
  EXPECT_EQ(way.guides, Guides::rendered);
  EXPECT_TRUE(way.merges && way.takesFullColour && !way.denoisesFirst);
  EXPECT_EQ(way.ratios, (std::vector<double>{4, 16}));
  EXPECT_EQ(way.mostNoise, -5);
  EXPECT_EQ(way.spread, 0.9);
}

TEST(Ways, PredictFromTheNoiseThatIsLeft) {
  Way way = read(kWays).front();
  const SceneFeatures scene{-2, -8, -6};
  EXPECT_EQ(way.noiseLeft(scene, {64, 4}), -9);  // 64 + 16 * 4 samples
  EXPECT_EQ(way.predictedPsnr(scene, {64, 4}), 10 + 2 * 9 + 0.5 * 8 + 0.25 * 8);
  way.merges = false;
  EXPECT_EQ(way.noiseLeft(scene, {64, 4}), -8);
  way.guides = Guides::free;
  EXPECT_EQ(way.predictedPsnr(scene, {64, 0}), 10 + 2 * 8 + 0.5 * 8) << "clean guides have no noise";
  way.scale = 1;
  EXPECT_EQ(way.noiseLeft(scene, {0, 4}), -4) << "full resolution has one render";
}

TEST(Ways, FilesThatTellNoneAreRefused) {
  std::string senseless = kWays;  // at scale 1 there is nothing to merge
  senseless.replace(senseless.find("\"scale\": 4"), 10, "\"scale\": 1");
  for (const std::string& text :
       {std::string("{"), std::string("{}"), std::string(R"({"ways": [{"name": 3}]})"), senseless})
    EXPECT_THROW(read(text), Error) << text;
  EXPECT_THROW(readWays("/nowhere/ways.json"), Error);
}

}  // namespace
}  // namespace xrds
