// Sequences whose frames are merged with those around them.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

constexpr int kFrames = 6, kWidth = 16, kHeight = 12;

// Numbers in [0, 1) that look like noise, the same on every machine.
float noise(int frame, int x, int y, int c) {
  const double mixed = 43758.5453 * std::sin(12.9898 * x + 78.233 * y + 37.719 * c + 11.13 * frame);
  return static_cast<float>(mixed - std::floor(mixed));
}

/// Frames 1 to 6 of a pattern that moves by 3 pixels of the full resolution to the right a frame, under noisy light.
struct MovingSequence {
  TemporaryFolder folder;

  explicit MovingSequence(const std::string& motion = "Vector", const std::string& channels = "XYZW") {
    for (int frame = 1; frame <= kFrames; ++frame) write(frame, motion, channels);
  }

  std::string at(const std::string& kind, int frame) const {
    return (folder / (kind + ".000" + std::to_string(frame) + ".exr")).string();
  }

  void write(int frame, const std::string& motion, const std::string& channels) const {
    const Box low = boxOf(kWidth, kHeight), full = boxOf(4 * kWidth, 4 * kHeight);
    writeParts(
        at("colour", frame),
        {{low, low, {Layer{"", "RGB", [=](int x, int y, int c) { return 0.3F + 0.6F * noise(frame, x, y, c); }}}}});
    const Layer albedo{"albedo", "RGB",
                       [=](int x, int y, int) { return (x - 3 * frame + 30) / 6 % 2 == y / 6 % 2 ? 0.3F : 0.7F; }};
    // Of Cycles' four: previous less present is -3, and present less next as well.
    const Layer vector{motion, channels, [](int, int, int c) { return c % 2 == 0 ? -3.F : 0.F; }};
    writeParts(at("aux", frame), {{full, full, {albedo, normalLayer("normal", 4 * kWidth), vector}}});
  }

  Ended run(const std::string& out, const Arguments& more = {}) const {
    Arguments all{"upscale",
                  (folder / "colour.####.exr").string(),
                  (folder / "aux.####.exr").string(),
                  "-o",
                  (folder / out / "f.####.exr").string(),
                  "--model",
                  goldenModel("s4_guided"),
                  "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    return runXrds(all);
  }
  std::string bytes(const std::string& out, int frame) const { return readBytes(at(out + "/f", frame)); }
};

// Chunks of a farm, what a killed run left, several jobs: always the same bytes.
TEST(CliTemporal, AFrameIsTheSameHoweverTheSequenceIsCut) {
  const MovingSequence sequence;
  ASSERT_EQ(sequence.run("whole", {"--temporal", "--temporal-radius", "2"}).exitCode, 0);
  const auto temporal = [](Arguments more) {
    more.insert(more.end(), {"--temporal", "--temporal-radius", "2"});
    return more;
  };
  ASSERT_EQ(sequence.run("chunks", temporal({"--frames", "4-6"})).exitCode, 0);
  ASSERT_EQ(sequence.run("chunks", temporal({"--frames", "1-3", "--jobs-per-device", "2"})).exitCode, 0);
  ASSERT_EQ(sequence.run("resumed", temporal({"--frames", "2,5"})).exitCode, 0);
  ASSERT_EQ(sequence.run("resumed", temporal({"--skip-existing"})).exitCode, 0);
  for (int frame = 1; frame <= kFrames; ++frame) {
    EXPECT_EQ(sequence.bytes("chunks", frame), sequence.bytes("whole", frame)) << frame;
    EXPECT_EQ(sequence.bytes("resumed", frame), sequence.bytes("whole", frame)) << frame;
  }
}

TEST(CliTemporal, APlainMotionLayerUsesFramesBefore) {
  const MovingSequence plain("speed", "XY"), cycles;
  ASSERT_EQ(plain.run("merged", {"--temporal", "--motion", "speed"}).exitCode, 0);
  ASSERT_EQ(plain.run("alone").exitCode, 0);
  EXPECT_EQ(plain.bytes("merged", 1), plain.bytes("alone", 1)) << "there is none before the first";
  ASSERT_EQ(cycles.run("merged", {"--temporal"}).exitCode, 0);
  EXPECT_EQ(plain.bytes("merged", kFrames), cycles.bytes("merged", kFrames)) << "there is none after the last";
  EXPECT_NE(plain.bytes("merged", 3), cycles.bytes("merged", 3));
}

TEST(CliTemporal, AFrameThatCannotBeReadFailsAloneAndEndsTheRow) {
  const MovingSequence sequence;
  fs::resize_file(sequence.at("aux", 3), 200);
  const Ended ended = sequence.run("out", {"--temporal"});
  EXPECT_EQ(ended.exitCode, 8) << ended.error;
  for (const int frame : {1, 2, 4, 5, 6}) EXPECT_TRUE(fs::exists(sequence.at("out/f", frame))) << frame;
}

TEST(CliTemporal, SaysWhatIsMissing) {
  const MovingSequence sequence("speed", "XYZW");
  const Ended ended = sequence.run("out", {"--temporal"});
  EXPECT_NE(ended.exitCode, 0);
  EXPECT_NE(ended.error.find("has no motion layer 'Vector'"), std::string::npos) << ended.error;
  const Ended single = runXrds({"upscale", sequence.at("colour", 1), sequence.at("aux", 1), "-o",
                                (sequence.folder / "one.exr").string(), "--temporal"});
  EXPECT_EQ(single.exitCode, 2) << single.error;
}

}  // namespace
}  // namespace xrds::test
