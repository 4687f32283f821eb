// Sequences whose frames are merged with those around them.
#include <gtest/gtest.h>

#include <thread>

#include "image/exr/read.h"
#include "tests/cli/moving_sequence.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

const Arguments kResume{"--temporal", "--temporal-radius", "2", "--skip-existing"};

/// Its frames upscaled.
struct UpscaledSequence : MovingSequence {
  using MovingSequence::MovingSequence;

  Arguments arguments(const std::string& out, const Arguments& more = {}) const {
    Arguments all{"upscale",
                  (folder / "colour.####.exr").string(),
                  (folder / "aux.####.exr").string(),
                  "-o",
                  (folder / out / "f.####.exr").string(),
                  "--model",
                  goldenModel("s4_guided"),
                  "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Ended run(const std::string& out, const Arguments& more = {}, const StartOptions& options = {}) const {
    return runXrds(arguments(out, more), options);
  }
  std::string bytes(const std::string& out, int frame) const { return readBytes(at(out + "/f", frame)); }

  size_t filesIn(const std::string& out, const std::string& extension) const {
    std::error_code none;
    size_t found = 0;
    for (fs::directory_iterator entry(folder / out, none), end; !none && entry != end; ++entry)
      found += entry->path().extension() == extension;
    return found;
  }

  /// All frames are there, with the bytes of one run over all of them.
  void expectWhole(const std::string& out) const {
    if (filesIn("one run", ".exr") == 0) {
      const Ended ended = run("one run", kResume);
      ASSERT_EQ(ended.exitCode, 0) << ended.error;
    }
    for (int frame = 1; frame <= kFrames; ++frame) EXPECT_EQ(bytes(out, frame), bytes("one run", frame)) << frame;
    EXPECT_EQ(filesIn(out, ".exr"), static_cast<size_t>(kFrames));
  }
};

// Chunks of a farm, what a killed run left, several jobs: always the same bytes.
TEST(CliTemporal, AFrameIsTheSameHoweverTheSequenceIsCut) {
  const UpscaledSequence sequence;
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

TEST(CliTemporal, MergesMoreFramesWhileThePictureStandsStill) {
  const auto firstFrame = [](int step, const Arguments& more) {
    const UpscaledSequence sequence({.frames = 9, .step = step});
    Arguments all{"--temporal", "--frames", "1"};
    all.insert(all.end(), more.begin(), more.end());
    const Ended ended = sequence.run("out", all);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    return sequence.bytes("out", 1);
  };
  const Arguments five{"--temporal-radius", "5"}, ten{"--temporal-radius", "10"};
  EXPECT_EQ(firstFrame(0, {}), firstFrame(0, ten));
  EXPECT_NE(firstFrame(0, {}), firstFrame(0, five));
  EXPECT_EQ(firstFrame(1, {}), firstFrame(1, five));
  EXPECT_NE(firstFrame(1, {}), firstFrame(1, ten));
}

TEST(CliTemporal, APlainMotionLayerUsesFramesBefore) {
  const UpscaledSequence plain({.layer = "speed", .channels = "XY"}), cycles;
  ASSERT_EQ(plain.run("merged", {"--temporal", "--motion", "speed"}).exitCode, 0);
  ASSERT_EQ(plain.run("alone").exitCode, 0);
  EXPECT_EQ(plain.bytes("merged", 1), plain.bytes("alone", 1)) << "there is none before the first";
  ASSERT_EQ(cycles.run("merged", {"--temporal"}).exitCode, 0);
  EXPECT_EQ(plain.bytes("merged", kFrames), cycles.bytes("merged", kFrames)) << "there is none after the last";
  EXPECT_NE(plain.bytes("merged", 3), cycles.bytes("merged", 3));
  EXPECT_TRUE(contains(headerOf(plain.at("merged/f", 3)).attributes.text("xrds:options").value_or(""), " temporal=3"));
}

// Killed while it starts, while a file is written, and between frames: what is missing is made with all frames around.
// The colour is that of a run without layers, and what they add up to.
TEST(CliTemporal, LightsAddUpToTheMergedColour) {
  MotionTold told;
  told.lights = true;
  const UpscaledSequence sequence(told);
  ASSERT_EQ(sequence.run("plain", {"--temporal"}).exitCode, 0);
  const Ended ended = sequence.run("lights", {"--temporal", "--layers", "all", "--frames", "2-4"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  for (int frame = 2; frame <= 4; ++frame) {
    const ExrFile plain = readExrHeader(sequence.at("plain/f", frame)),
                  made = readExrHeader(sequence.at("lights/f", frame));
    const Image colour = readLayer(plain, {0, "", {"R", "G", "B"}}), sum = readLayer(made, {0, "", {"R", "G", "B"}}),
                emission = readLayer(made, {0, "Emit", {"Emit.R", "Emit.G", "Emit.B"}}),
                world = readLayer(made, {0, "Env", {"Env.R", "Env.G", "Env.B"}});
    for (size_t i = 0; i < colour.pixels.size(); ++i) {
      ASSERT_EQ(sum.pixels[i], colour.pixels[i]) << i;
      ASSERT_NEAR(emission.pixels[i] + world.pixels[i], sum.pixels[i], 1e-5F * sum.pixels[i]) << i;
      ASSERT_NEAR(emission.pixels[i], 0.3F * sum.pixels[i], 1e-3F * sum.pixels[i]) << i;
    }
  }
}

TEST(CliTemporal, GoesOnAfterBeingKilledWithTheSameBytes) {
  const UpscaledSequence sequence;
  const auto killedWhen = [&](const std::function<bool()>& due) {
    const Ended killed = killXrds(sequence.arguments("out", kResume), due);
    EXPECT_TRUE(killed.exitCode == 1009 || killed.exitCode == 0) << killed.error;
  };
  killedWhen([] { return true; });
  killedWhen([&] { return sequence.filesIn("out", ".part") > 0; });
  for (const size_t due : {1, 2, 4}) killedWhen([&] { return sequence.filesIn("out", ".exr") >= due; });
  const Ended ended = sequence.run("out", kResume);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  sequence.expectWhole("out");
}

TEST(CliTemporal, TwoProcessesOnOneRange) {
  const UpscaledSequence sequence;
  Ended other;
  std::thread beside([&] { other = sequence.run("out", kResume); });
  const Ended ended = sequence.run("out", kResume);
  beside.join();
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(other.exitCode, 0) << other.error;
  sequence.expectWhole("out");
}

TEST(CliTemporal, AFullDiskEndsItAndLeavesNothing) {
  const UpscaledSequence sequence;
  const Ended full = sequence.run("out", kResume, {.largestFileBytes = 500});
  EXPECT_EQ(full.exitCode, 6) << full.error;
  EXPECT_EQ(sequence.filesIn("out", ".exr") + sequence.filesIn("out", ".part"), 0U);
  EXPECT_EQ(sequence.run("out", kResume).exitCode, 0);
  sequence.expectWhole("out");
}

// Cut off, or no file at all: the frames around are made, say so, and are made again once it can be read; no others.
TEST(CliTemporal, FramesMadeWithoutOneThatCannotBeReadAreMadeAgain) {
  const UpscaledSequence sequence;
  const fs::path damaged = sequence.at("aux", 5), kept = sequence.folder / "kept.exr";
  const auto damage = [&](bool cut) {
    fs::remove_all(sequence.folder / "out");
    fs::copy_file(damaged, kept, fs::copy_options::overwrite_existing);
    if (cut) return fs::resize_file(damaged, fs::file_size(damaged) / 2);
    fs::remove(damaged);
    fs::create_directory(damaged);
  };
  for (const bool cut : {true, false}) {
    damage(cut);
    const Ended ended = sequence.run("out", kResume);
    EXPECT_EQ(ended.exitCode, 8) << ended.error;
    EXPECT_NE(ended.error.find("Frames that failed: 5."), std::string::npos) << ended.error;
    EXPECT_NE(ended.error.find("merged without frames that cannot be read or merged: 5"), std::string::npos)
        << ended.error;
    EXPECT_EQ(sequence.filesIn("out", ".exr"), 5U);
    const auto untouched = fs::last_write_time(sequence.at("out/f", 2)),
               without = fs::last_write_time(sequence.at("out/f", 3));
    EXPECT_EQ(sequence.run("out", kResume).exitCode, 8);
    EXPECT_EQ(fs::last_write_time(sequence.at("out/f", 3)), without) << "it would be the same again";
    fs::remove_all(damaged);
    fs::rename(kept, damaged);
    EXPECT_EQ(sequence.run("out", kResume).exitCode, 0);
    EXPECT_EQ(fs::last_write_time(sequence.at("out/f", 2)), untouched);
    EXPECT_NE(fs::last_write_time(sequence.at("out/f", 3)), without);
    sequence.expectWhole("out");
  }
}

// The pattern stands still before a camera: the motion, and so the frames, are the same as those of the Vector pass.
TEST(CliTemporal, FollowsCamerasWhereThereIsNoMotionLayer) {
  const UpscaledSequence told({.byCameras = true}), vector;
  ASSERT_EQ(told.run("out", kResume).exitCode, 0);
  ASSERT_EQ(vector.run("out", kResume).exitCode, 0);
  for (int frame = 1; frame <= kFrames; ++frame) EXPECT_EQ(told.bytes("out", frame), vector.bytes("out", frame));
  // A frame whose camera is not known ends the rows of those beside it.
  fs::resize_file(told.at("aux", 5), 200);
  const Ended ended = told.run("damaged", kResume);
  EXPECT_EQ(ended.exitCode, 8) << ended.error;
  EXPECT_NE(ended.error.find("merged without frames that cannot be read or merged: 5"), std::string::npos)
      << ended.error;
  EXPECT_EQ(told.bytes("damaged", 1), told.bytes("out", 1));
  EXPECT_NE(told.bytes("damaged", 4), told.bytes("out", 4));
}

TEST(CliTemporal, SaysWhatIsMissing) {
  const UpscaledSequence sequence({.layer = "speed"});
  const Ended ended = sequence.run("out", {"--temporal"});
  EXPECT_NE(ended.exitCode, 0);
  EXPECT_NE(ended.error.find("has no motion layer 'Vector'"), std::string::npos) << ended.error;
  EXPECT_EQ(ended.error.find("' holds"), ended.error.rfind("' holds")) << "the layers once: " << ended.error;
  const Ended single = runXrds({"upscale", sequence.at("colour", 1), sequence.at("aux", 1), "-o",
                                (sequence.folder / "one.exr").string(), "--temporal"});
  EXPECT_EQ(single.exitCode, 2) << single.error;
}

TEST(CliTemporal, MotionAndDepthAreOfTheViewLayerOfTheColour) {
  const UpscaledSequence alone({.depth = true}), beside({.depth = true, .viewLayers = true});
  ASSERT_EQ(alone.run("out", {"--temporal", "--frames", "3"}).exitCode, 0);
  const Ended ended = beside.run("out", {"--temporal", "--frames", "3", "--color", "B.Combined"});
  ASSERT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(beside.bytes("out", 3), alone.bytes("out", 3));
  // Of a colour that is of no view layer.
  const MovingSequence unnamed;
  fs::copy_file(unnamed.at("colour", 3), beside.at("colour", 3), fs::copy_options::overwrite_existing);
  const Ended unclear = beside.run(
      "unclear", {"--temporal", "--frames", "3", "--albedo", "B.albedo", "--normal", "B.normal", "--depth", "B.Depth"});
  EXPECT_EQ(unclear.exitCode, 8);
  EXPECT_TRUE(contains(unclear.error, "found 0:A.Vector, 0:B.Vector; name the one to use with --motion"))
      << unclear.error;
  const Ended named = beside.run("named", {"--temporal", "--frames", "3", "--albedo", "B.albedo", "--normal",
                                           "B.normal", "--depth", "B.Depth", "--motion", "0:B.Vector"});
  EXPECT_EQ(named.exitCode, 0) << named.error;
}

// Both renders in one file, each with its passes.
TEST(CliTemporal, MotionAndDepthAreThoseOfTheLargerRender) {
  const TemporaryFolder folder;
  const auto zero = [](int, int, int) { return 0.F; };
  const auto render = [&](int width, const std::string& name) {
    return Part{boxOf(width, width), boxOf(64, 64), {{"Vector", "XYZW", zero}, colourLayer("Combined", width)}, name};
  };
  Part low = render(16, "low"), full = render(64, "full");
  full.layers.insert(full.layers.end(), {albedoLayer("albedo", 64), normalLayer("normal", 64)});
  for (const char* name : {"r.0001.exr", "r.0002.exr"}) writeParts(folder / name, {low, full});
  const Ended ended =
      runXrds({"upscale", (folder / "r.####.exr").string(), "-o", (folder / "out").string(), "--temporal", "--frames",
               "1", "--aux-colour", "never", "--model", goldenModel("s4_guided"), "--quiet"});
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
}

}  // namespace
}  // namespace xrds::test
