// Sequences of `xrds denoise`, by small networks of random weights.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

constexpr int kFrames = 4, kWidth = 40, kHeight = 24;

/// Frames 1 to 4 of a still view under noisy light, each in one file with alpha and all guides, and the networks.
struct RenderedSequence {
  TemporaryFolder folder;

  RenderedSequence() {
    writeDenoisers(folder / "networks");
    for (int frame = 1; frame <= kFrames; ++frame) write(frame);
  }

  std::string at(const std::string& kind, int frame) const {
    return (folder / (kind + ".000" + std::to_string(frame) + ".exr")).string();
  }

  void write(int frame) const {
    const auto random = std::make_shared<std::mt19937>(frame);
    const Box box = boxOf(kWidth, kHeight);
    const Pixels light = [random](int x, int y, int c) {
      if (c == 3) return static_cast<float>((x + y) % 5) / 4;  // alpha
      std::uniform_real_distribution<float> noise(0.2F, 1.4F);
      return noise(*random);
    };
    writeParts(at("render", frame), {{box,
                                      box,
                                      {{"", "RGBA", light},
                                       albedoLayer("albedo", kWidth),
                                       normalLayer("normal", kWidth),
                                       {"Vector", "XYZW", [](int, int, int) { return 0.F; }}}}});
  }

  Ended denoise(const std::string& from, const std::string& to, const Arguments& more = {}) const {
    Arguments all{"denoise", from, "-o", to, "--denoisers", (folder / "networks").string(), "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    return runXrds(all);
  }
  Ended denoiseAll(const std::string& out, const Arguments& more = {}) const {
    return denoise((folder / "render.####.exr").string(), (folder / (out + ".####.exr")).string(), more);
  }

  // How much the pixels of the frames vary over time, root mean square.
  double variation(const std::string& kind) const {
    std::vector<Image> frames;
    for (int frame = 1; frame <= kFrames; ++frame) frames.push_back(readColour(at(kind, frame)));
    double sum = 0;
    for (size_t i = 0; i < frames[0].pixels.size(); ++i) {
      double mean = 0, square = 0;
      for (const Image& frame : frames) mean += frame.pixels[i] / kFrames;
      for (const Image& frame : frames) square += std::pow(frame.pixels[i] - mean, 2) / kFrames;
      sum += square;
    }
    return std::sqrt(sum / static_cast<double>(frames[0].pixels.size()));
  }
};

TEST(CliDenoiseSequence, AFrameIsThatOfARunOfItsOwn) {
  const RenderedSequence sequence;
  for (const Arguments& more : {Arguments{}, {"--guides", "clean", "--half"}, {"--guides", "none", "--memory", "3M"}}) {
    const Ended all = sequence.denoiseAll("all", more);
    ASSERT_EQ(all.exitCode, 0) << all.error;
    for (const int frame : {1, kFrames}) {
      const Ended one = sequence.denoise(sequence.at("render", frame), sequence.at("one", frame), more);
      ASSERT_EQ(one.exitCode, 0) << one.error;
      EXPECT_EQ(readBytes(sequence.at("all", frame)), readBytes(sequence.at("one", frame))) << frame;
    }
  }
}

TEST(CliDenoiseSequence, MergedFramesVaryLessOverTime) {
  const RenderedSequence sequence;
  for (const auto& [out, more] : {std::pair{"alone", Arguments{}}, {"merged", {"--temporal"}}}) {
    const Ended ended = sequence.denoiseAll(out, more);
    ASSERT_EQ(ended.exitCode, 0) << ended.error;
  }
  EXPECT_LT(sequence.variation("merged"), 0.5 * sequence.variation("alone"));
}

// Motion needs no guides; a folder that is not there is made.
TEST(CliDenoiseSequence, TheColourAloneIsMergedToo) {
  const RenderedSequence sequence;
  const Ended ended = sequence.denoise((sequence.folder / "render.####.exr").string(),
                                       (sequence.folder / "new").string(), {"--temporal", "--guides", "none"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  for (int frame = 1; frame <= kFrames; ++frame) EXPECT_TRUE(fs::exists(sequence.at("new/render", frame))) << frame;
}

TEST(CliDenoiseSequence, BrokenFramesAreToldAndMadeLater) {
  const RenderedSequence sequence;
  for (const int frame : {1, 3}) fs::resize_file(sequence.at("render", frame), 100);
  const Ended ended = sequence.denoiseAll("out");
  EXPECT_EQ(ended.exitCode, 8);
  EXPECT_NE(ended.error.find("Frames that failed: 1, 3."), std::string::npos) << ended.error;
  for (int frame = 1; frame <= kFrames; ++frame) {
    EXPECT_EQ(fs::exists(sequence.at("out", frame)), frame % 2 == 0) << frame;
    sequence.write(frame);
  }
  const auto written = fs::last_write_time(sequence.at("out", 2));
  EXPECT_EQ(sequence.denoiseAll("out", {"--skip-existing"}).exitCode, 0);
  EXPECT_TRUE(fs::exists(sequence.at("out", 1)) && fs::exists(sequence.at("out", 3)));
  EXPECT_EQ(fs::last_write_time(sequence.at("out", 2)), written);
}

TEST(CliDenoiseSequence, OptionsOfOneFrameAndOfManyAreToldApart) {
  const RenderedSequence sequence;
  const Ended one = sequence.denoise(sequence.at("render", 1), sequence.at("out", 1), {"--temporal"});
  EXPECT_EQ(one.exitCode, 2);
  EXPECT_NE(one.error.find("--temporal is for sequences"), std::string::npos) << one.error;
  const Ended many = sequence.denoiseAll("out", {"--preview", (sequence.folder / "out.png").string()});
  EXPECT_EQ(many.exitCode, 2);
  EXPECT_NE(many.error.find("--preview is for one frame"), std::string::npos) << many.error;
  writeParts(sequence.at("large", 1),
             {{boxOf(80, 48), boxOf(80, 48), {albedoLayer("albedo", 80), normalLayer("normal", 80)}}});
  const std::string renders = (sequence.folder / "render.####.exr").string();
  const Ended larger = runXrds(
      {"denoise", renders, sequence.at("large", 1), "-o", (sequence.folder / "out.####.exr").string(), "--quiet"});
  EXPECT_EQ(larger.exitCode, 3);
  EXPECT_NE(larger.error.find("2 times the colour's size"), std::string::npos) << larger.error;
  fs::remove(sequence.folder / "networks" / "rt_nrm.safetensors");
  const Ended missing = sequence.denoiseAll("out");
  EXPECT_EQ(missing.exitCode, 4);
  EXPECT_NE(missing.error.find("There is no network rt_nrm"), std::string::npos) << missing.error;
}

}  // namespace
}  // namespace xrds::test
