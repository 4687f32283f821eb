// Scenes that are traced and upscaled while one looks at them.
#include "tests/viewer/viewer_display.h"

namespace xrds::test {
namespace {

/// 64 x 64 to 256 x 256, on a display of little more.
std::vector<std::string> live(const std::string& scene, const std::string& samples,
                              std::vector<std::string> more = {}) {
  more.insert(more.end(), {"--live", scene, "--live-size", "64x64", "--samples", samples, "--size", "320x260"});
  return more;
}

Image pictureIn(const Image& screenshot) { return cropped(screenshot, 32, 2, 256, 256); }

TEST_F(ViewerDisplay, ShowsTheBuiltInScenes) {
  for (const std::string scene : {"room", "garden", "spheres"}) {
    const std::string file = "live_" + scene + ".png";
    const Ended ended = run("key P\nkey W\nwait\nscreenshot " + file + "\nwait\nprint\n", live(scene, "8"));
    EXPECT_TRUE(has(ended.output, "model=xrds-x4-mini")) << ended.output;
    EXPECT_EQ(valuesOf(ended.output, "samples"), std::vector<double>{8});
    expectLikeStored(folder / file);
  }
}

TEST_F(ViewerDisplay, ShowsSceneFiles) {
  writeBytes(folder / "roof.mtl", "newmtl red\nKd 0.7 0.1 0.1\nnewmtl grey\nKd 0.5 0.5 0.5\n");
  writeBytes(folder / "roof.obj",
             "mtllib roof.mtl\nv -3 0 -3\nv 3 0 -3\nv 3 0 3\nv -3 0 3\nv -1 0 1\nv 1 0 1\nv 0 2 0\nv 0 0 -1\n"
             "usemtl grey\nf 4 3 2 1\nusemtl red\nf 5 6 7\nf 6 8 7\nf 8 5 7\n");
  // A triangle of corners (0, 0, 0), (2, 0, 0), (0, 1, 0) before a camera.
  writeBytes(folder / "corner.gltf", R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0.8, 0.4, 3]}],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 0.6, "aspectRatio": 1, "znear": 0.1, "zfar": 100}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
    "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.3, 0.7, 1], "metallicFactor": 0}}],
    "buffers": [{"byteLength": 44, "uri":
      "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA="}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                   "max": [2, 1, 0]},
                  {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}]})");
  for (const std::string file : {"roof.obj", "corner.gltf"}) {
    const std::string shot = "live_" + file.substr(0, file.find('.')) + ".png";
    run("key P\nkey W\nwait\nscreenshot " + shot + "\nwait\n", live(file, "16"));
    expectLikeStored(folder / shot);
  }
}

TEST_F(ViewerDisplay, OrbitsAndBeginsAnewWhenMoved) {
  const Ended ended =
      run("key P\nkey W\nwait\nprint\nscreenshot start.png\nmove 100 100\npress\nmove 130 100\nrelease\nwait\nprint\n"
          "screenshot turned.png\nkey I\nwait\nprint\nscreenshot closer.png\nkey V\nwait\nprint\n"
          "screenshot again.png\nwait\n",
          live("room", "12", {"--temporal", "off"}));
  EXPECT_EQ(valuesOf(ended.output, "samples"), (std::vector<double>{12, 12, 12, 12}));
  // Without what was shown before, as many pictures for each view: each began with one sample.
  const std::vector<double> pictures = valuesOf(ended.output, "pictures");
  ASSERT_EQ(pictures.size(), 4u) << ended.output;
  EXPECT_GT(pictures[0], 4);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(pictures[i], static_cast<double>(i + 1) * pictures[0]) << ended.output;
  const auto shot = [&](const char* name) { return pictureIn(readPng(folder / name)); };
  EXPECT_GT(meanDifference(shot("start.png"), shot("turned.png")), 5);
  EXPECT_GT(meanDifference(shot("turned.png"), shot("closer.png")), 5);
  EXPECT_LT(meanDifference(shot("start.png"), shot("again.png")), 0.05);
}

TEST_F(ViewerDisplay, DoesNotFlickerWhileNothingMoves) {
  const auto shot = [&](const std::string& samples) {
    run("key P\nkey W\nwait\nscreenshot a.png\nmove 20 20\nwait\nscreenshot b.png\nwait\n", live("room", samples));
    const Image a = pictureIn(readPng(folder / "a.png"));
    EXPECT_EQ(meanDifference(a, pictureIn(readPng(folder / "b.png"))), 0);
    return a;
  };
  EXPECT_LT(meanDifference(shot("120"), shot("128")), 1) << "from one picture to the next";
}

TEST_F(ViewerDisplay, TakesStepsBeforeAllSamplesAreThere) {
  const Ended ended = run("samples 2\nwait\nprint\nkey Shift+Left\nwait\nprint\n", live("spheres", "1000000"));
  const std::vector<double> samples = valuesOf(ended.output, "samples");
  ASSERT_EQ(samples.size(), 2u) << ended.output;
  for (const double count : samples) {
    EXPECT_GE(count, 2);
    EXPECT_LT(count, 1000000);
  }
}

TEST_F(ViewerDisplay, SaysThatItPreparesALiveScene) {
  run("!screenshot preparing.png\n!wait\n!wait\n!key Q\n", live("room", "4"));
  const Image shot = readPng(folder / "preparing.png");
  double brightest = 0;
  for (const float value : cropped(shot, 40, 60, 240, 140).pixels)
    brightest = std::max(brightest, static_cast<double>(value));
  EXPECT_GT(brightest, 200) << "letters in the middle of the display";
}

// Nothing can be waited for: that nothing happens shows in a stretch of time alone, and most of it is asleep.
TEST_F(ViewerDisplay, CostsNothingWhileNothingHappens) {
  const Ended ended = run("wait\nclock\nsleep 3\nclock\n", live("room", "4"));
  ASSERT_EQ(valuesOf(ended.output, "seconds").size(), 2u) << ended.output;
  EXPECT_GE(valuesOf(ended.output, "seconds")[1], 3);
  EXPECT_LT(valuesOf(ended.output, "processor")[1], 0.05 * 3);
  EXPECT_EQ(valuesOf(ended.output, "drawings")[1], 0);
}

// Each key is drawn, though the pictures of the last are still to come; bench/viewer.md has how long it takes.
TEST_F(ViewerDisplay, AnswersWhileItComputes) {
  std::string script = "wait\nclock\n";
  for (int i = 0; i < 12; ++i) script += "!key Shift+Left\n";
  const Ended ended = run(script + "!clock\n!print\nwait\nprint\n", live("room", "8"));
  ASSERT_EQ(valuesOf(ended.output, "drawings").size(), 2u) << ended.output;
  EXPECT_GE(valuesOf(ended.output, "drawings")[1], 12);
  const std::vector<double> pictures = valuesOf(ended.output, "pictures");
  ASSERT_EQ(pictures.size(), 2u) << ended.output;
  EXPECT_LT(pictures[0], pictures[1]) << ended.output;
}

TEST(Headless, TimesTheLoopWithoutADisplay) {
  const StartOptions nowhere{.environment = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}};
  const Ended ended =
      runXrds({"view", "--headless", "--live", "spheres", "--live-size", "16x12", "--frames", "2"}, nowhere);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(has(ended.output, "16 x 12 to 64 x 48")) << ended.output;
  EXPECT_TRUE(has(ended.output, "pictures 2 in ")) << ended.output;
  EXPECT_EQ(runXrds({"view", "--headless", "--live", "spheres"}, nowhere).exitCode, 2);
}

}  // namespace
}  // namespace xrds::test
