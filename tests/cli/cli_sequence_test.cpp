// Sequences of frames in one command.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/cli/frames.h"
#include "tests/cli/process.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

/// Frames 1 to `count` in a folder: colour.0001.exr of 10 x 8 pixels, brighter from frame to frame, and aux.0001.exr.
struct Sequence {
  TemporaryFolder folder;
  int count;

  explicit Sequence(int frames) : count(frames) {
    for (int frame = 1; frame <= frames; ++frame) write(frame, 10, 8);
  }

  std::string at(const char* kind, int frame) const {
    char name[64];
    std::snprintf(name, sizeof name, "%s.%04d.exr", kind, frame);
    return (folder / name).string();
  }
  std::string out(int frame) const { return at("out/frame", frame); }

  void write(int frame, int width, int height, const std::string& alpha = "") const {
    const auto light = [frame](int x, int y, int c) { return 0.1F * static_cast<float>(frame + x + 2 * y + c); };
    writeParts(at("colour", frame), {{boxOf(width, height), boxOf(width, height), {Layer{"", "RGB" + alpha, light}}}});
    writeParts(at("aux", frame), {{boxOf(4 * width, 4 * height),
                                   boxOf(4 * width, 4 * height),
                                   {albedoLayer("albedo", 4 * width), normalLayer("normal", 4 * width)}}});
  }

  Arguments arguments(const Arguments& more = {}) const {
    Arguments all{"upscale",
                  (folder / "colour.####.exr").string(),
                  (folder / "aux.%04d.exr").string(),
                  "-o",
                  (folder / "out/frame.####.exr").string(),
                  "--model",
                  goldenModel("s4_guided")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  /// The bytes of the output that a run of this frame alone makes.
  std::string alone(int frame) const {
    const std::string output = (folder / "alone.exr").string();
    const Ended ended =
        runXrds({"upscale", at("colour", frame), at("aux", frame), "-o", output, "--model", goldenModel("s4_guided")});
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    std::string bytes = readBytes(output);
    fs::remove(output);
    return bytes;
  }

  void expectWhole() const {
    for (int frame = 1; frame <= count; ++frame) EXPECT_EQ(readBytes(out(frame)), alone(frame)) << frame;
    EXPECT_EQ(filesOut(), static_cast<size_t>(count)) << "nothing else is there";
  }

  size_t filesOut() const {
    std::error_code none;
    size_t found = 0;
    for (fs::directory_iterator entry(folder / "out", none), end; !none && entry != end; ++entry) ++found;
    return found;
  }
};

/// The same as pixels, whatever the model is called.
std::vector<float> pixelsAlone(const Sequence& sequence, int frame) {
  const std::string file = (sequence.folder / "picture.exr").string();
  std::ofstream(file, std::ios::binary) << sequence.alone(frame);
  return readColour(file).pixels;
}

TEST(CliSequence, EveryFrameIsThatOfARunAlone) {
  const Sequence sequence(5);
  const Ended ended = runXrds(sequence.arguments());
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "5 frames made")) << ended.output;
  EXPECT_TRUE(contains(ended.error, "5 of 5 frames (100 %)")) << ended.error;
  EXPECT_TRUE(contains(ended.error, "slowest stage")) << ended.error;
  sequence.expectWhole();
}

TEST(CliSequence, AFirstFrameThatShowsNothingDoesNotChooseTheModel) {
  const Sequence sequence(3);
  const TemporaryFolder models;
  for (const auto& [golden, shipped] :
       {std::pair{"s4_guided", "xrds-x4-compact"}, {"s4_concat_noaux", "xrds-x4-compact-plain"}})
    fs::copy_file(goldenModel(golden), models / (std::string(shipped) + ".safetensors"));
  const auto one = [](int, int, int) { return 1.0F; };
  const auto empty = [&](int frame) {
    writeParts(sequence.at("aux", frame),
               {{boxOf(40, 32), boxOf(40, 32), {{"albedo", "RGB", one}, {"normal", "XYZ", one}}}});
  };
  Arguments arguments = sequence.arguments();
  arguments.resize(arguments.size() - 2);  // without --model
  const auto made = [&] { return runXrds(arguments, {.environment = {{"XRDS_MODELS", (models / "").string()}}}); };
  empty(1);
  const Ended shown = made();
  EXPECT_EQ(shown.exitCode, 0) << shown.error;
  EXPECT_FALSE(contains(shown.error, "taking model")) << shown.error;
  EXPECT_EQ(readColour(sequence.out(2)).pixels, pixelsAlone(sequence, 2));
  empty(2);
  empty(3);
  const Ended never = made();
  EXPECT_TRUE(contains(never.error, "The albedo is the same everywhere; taking model xrds-x4-compact-plain."))
      << never.error;
}

TEST(CliSequence, WarningsThatDifferInNumbersAreToldOnceAndForWhichFrames) {
  const Sequence sequence(3);
  for (int frame = 1; frame <= 3; ++frame) {
    const auto light = [frame](int x, int y, int) { return y == 0 && x <= frame ? -1.0F : 0.5F; };
    writeParts(sequence.at("colour", frame), {{boxOf(10, 8), boxOf(10, 8), {Layer{"", "RGB", light}}}});
  }
  const Ended ended = runXrds(sequence.arguments());
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  size_t told = 0;
  for (size_t at = 0; (at = ended.error.find(" pixels of layer", at)) != std::string::npos; ++at) ++told;
  EXPECT_EQ(told, 2U) << ended.error;
  EXPECT_TRUE(contains(ended.error, "warning: frames 1-3 had this warning, or one with other numbers: frame "))
      << ended.error;
}

TEST(CliSequence, FoldersOneGuideForAllAndTheOtherOrder) {
  const Sequence sequence(3);
  const fs::path renders = sequence.folder / "renders";
  fs::create_directories(renders);
  for (int frame = 1; frame <= 3; ++frame) {
    fs::rename(sequence.at("colour", frame), renders / ("v1_c" + std::to_string(frame) + ".exr"));
    if (frame > 1) fs::remove(sequence.at("aux", frame));
  }
  const Arguments arguments{
      "upscale", sequence.at("aux", 1),    renders.string(),    "-o", (sequence.folder / "out/").string(),
      "--model", goldenModel("s4_guided"), "--jobs-per-device", "2"};
  const Ended ended = runXrds(arguments);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  for (int frame = 1; frame <= 3; ++frame)
    EXPECT_EQ(readColour((sequence.folder / "out" / ("v1_c" + std::to_string(frame) + ".exr")).string()).width, 40);
}

TEST(CliSequence, OutputsInAFolderAreNamedAsTheColourInAnyOrder) {
  const Sequence sequence(2);
  Arguments swapped = sequence.arguments();
  std::swap(swapped[1], swapped[2]);
  swapped[4] = (sequence.folder / "out/").string();
  const Ended ended = runXrds(swapped);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(fs::exists(sequence.at("out/colour", 2))) << ended.output;
  EXPECT_EQ(sequence.filesOut(), 2U);
}

TEST(CliSequence, ChosenFramesOfAnySizeAndWithAlpha) {
  const Sequence sequence(6);
  sequence.write(3, 12, 9);
  sequence.write(5, 12, 9, "A");
  const Ended ended = runXrds(sequence.arguments({"--frames", "5-1:-2", "--half"}));
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(sequence.filesOut(), 3U);
  EXPECT_EQ(readColour(sequence.out(1)).width, 40);
  EXPECT_EQ(readColour(sequence.out(3)).width, 48);
  EXPECT_EQ(headerOf(sequence.out(5)).layers.front().channels.size(), 4U);
}

TEST(CliSequence, BadFramesAreListedAndTheOthersMade) {
  const Sequence sequence(7);
  fs::remove(sequence.at("colour", 2));
  fs::resize_file(sequence.at("aux", 4), fs::file_size(sequence.at("aux", 4)) / 2);
  writeParts(sequence.at("aux", 6),
             {{boxOf(44, 32), boxOf(44, 32), {albedoLayer("albedo", 44), normalLayer("normal", 44)}}});
  const std::string log = (sequence.folder / "run.json").string();
  const Ended ended = runXrds(sequence.arguments({"--frames", "1-7", "--log", log}));
  EXPECT_EQ(ended.exitCode, 8) << ended.error;
  EXPECT_TRUE(contains(ended.error, "Frames that failed: 2, 4, 6.") ||
              contains(ended.error, "Frames that failed: 2-6:2."))
      << ended.error;
  EXPECT_TRUE(contains(ended.error, "frame 2 failed: ")) << ended.error;
  EXPECT_EQ(sequence.filesOut(), 4U);
  for (const int frame : {1, 3, 5, 7}) EXPECT_EQ(readBytes(sequence.out(frame)), sequence.alone(frame)) << frame;
  const Json json = Json::parse(readBytes(log));
  EXPECT_EQ(json["frames"], (Json{{"made", 4}, {"there", 0}, {"failed", 3}, {"notReached", 0}}));
  ASSERT_EQ(json["rows"].size(), 7U);
  EXPECT_EQ(json["rows"][1]["state"], "failed");
  EXPECT_EQ(json["rows"][1]["stage"], "reading");
  EXPECT_EQ(json["rows"][1]["exitCode"], 3);
  EXPECT_TRUE(contains(json["rows"][1]["message"], "colour.0002.exr")) << json["rows"][1];
  EXPECT_GT(json["rows"][0]["seconds"]["computing"].get<double>(), 0);
}

TEST(CliSequence, WhatIsThereIsSkipped) {
  const Sequence sequence(4);
  fs::create_directories(sequence.folder / "out");
  std::ofstream(sequence.out(2)) << "mine";
  const Ended ended = runXrds(sequence.arguments({"--skip-existing"}));
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(contains(ended.output, "3 frames made") && contains(ended.output, "1 were there")) << ended.output;
  EXPECT_EQ(readBytes(sequence.out(2)), "mine");
  const std::string log = (sequence.folder / "run.json").string();
  const Ended again = runXrds(sequence.arguments({"--skip-existing", "--log", log}));
  EXPECT_EQ(again.exitCode, 0) << again.error;
  EXPECT_TRUE(contains(again.output, "all 4 frames are there")) << again.output;
  EXPECT_EQ(Json::parse(readBytes(log))["frames"], (Json{{"made", 0}, {"there", 4}, {"failed", 0}, {"notReached", 0}}));
}

TEST(CliSequence, GoesOnAfterBeingKilled) {
  const Sequence sequence(8);
  for (const size_t due : {1, 3, 6}) {
    const Ended killed = killXrds(sequence.arguments({"--skip-existing"}), [&] { return sequence.filesOut() >= due; });
    ASSERT_TRUE(killed.exitCode == 1009 || killed.exitCode == 0) << killed.error;
  }
  const Ended ended = runXrds(sequence.arguments({"--skip-existing"}));
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  for (const auto& entry : fs::directory_iterator(sequence.folder / "out"))
    if (entry.path().extension() == ".part") {  // of a kill in the middle of writing: goes when it is an hour old
      fs::last_write_time(entry.path(), fs::file_time_type::clock::now() - std::chrono::hours(2));
    }
  runXrds(sequence.arguments());
  sequence.expectWhole();
}

TEST(CliSequence, TwoProcessesOnOneRange) {
  const Sequence sequence(6);
  Ended other;
  std::thread beside([&] { other = runXrds(sequence.arguments({"--skip-existing"})); });
  const Ended ended = runXrds(sequence.arguments({"--skip-existing"}));
  beside.join();
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(other.exitCode, 0) << other.error;
  sequence.expectWhole();
}

TEST(CliSequence, AFullDiskEndsItAfterAFewFrames) {
  const Sequence sequence(8);
  const Ended ended = runXrds(sequence.arguments(), {.largestFileBytes = 500});
  EXPECT_EQ(ended.exitCode, 6) << ended.error;
  EXPECT_TRUE(contains(ended.error, "3 failures in a row")) << ended.error;
  EXPECT_EQ(sequence.filesOut(), 0U);
}

TEST(CliSequence, UnchangedWindowsAreKeptBitForBit) {
  const Sequence sequence(3);
  fs::copy_file(sequence.at("colour", 1), sequence.at("colour", 2), fs::copy_options::overwrite_existing);
  const Ended kept = runXrds(sequence.arguments({"--exposure", "0.5", "--tiles", "exact", "--keep-unchanged"}));
  ASSERT_EQ(kept.exitCode, 0) << kept.error;
  std::vector<std::string> bytes;
  for (int frame = 1; frame <= 3; ++frame) bytes.push_back(readBytes(sequence.out(frame)));
  ASSERT_EQ(runXrds(sequence.arguments({"--exposure", "0.5", "--tiles", "exact"})).exitCode, 0);
  for (int frame = 1; frame <= 3; ++frame) EXPECT_EQ(readBytes(sequence.out(frame)), bytes[frame - 1]) << frame;
}

TEST(CliSequence, ControlCLeavesWholeFramesAlone) {
  const Sequence sequence(200);
  const Ended ended = runOnTerminal(sequence.arguments(), "of 200 frames", "\x03");
  EXPECT_EQ(ended.exitCode, 130) << ended.output;
  EXPECT_LT(sequence.filesOut(), 200U);
  for (const auto& entry : fs::directory_iterator(sequence.folder / "out"))
    EXPECT_EQ(entry.path().extension(), ".exr") << entry.path();
}

TEST(CliSequence, WrongUseIsTold) {
  const Sequence sequence(2);
  const auto error = [&](const Arguments& arguments, int code) {
    const Ended ended = runXrds(arguments);
    EXPECT_EQ(ended.exitCode, code) << ended.error;
    EXPECT_EQ(sequence.filesOut(), 0U);
    return ended.error;
  };
  EXPECT_TRUE(contains(error(sequence.arguments({"--frames", "1-"}), 2), "names no frames"));
  EXPECT_TRUE(contains(error(sequence.arguments({"--frames", ""}), 2), "names no frames"));
  EXPECT_TRUE(contains(error(sequence.arguments({"--devices", "0,,0"}), 2), "empty name between its commas"));
  EXPECT_TRUE(contains(error(sequence.arguments({"--devices", "1,0,1"}), 2), "names '1' twice"));
  EXPECT_TRUE(contains(error(sequence.arguments({"--json", "a.json"}), 2), "--log"));
  EXPECT_TRUE(contains(error(sequence.arguments({"--keep-unchanged"}), 2), "--exposure"));
  EXPECT_TRUE(contains(error(sequence.arguments({"--frames", "8-9"}), 3), "No frame can be read"));
  Arguments one = sequence.arguments();
  one[4] = (sequence.folder / "out.exr").string();
  EXPECT_TRUE(contains(error(one, 2), "one file for many frames"));
  one[4] = "/proc/out.####.exr";  // not even for the superuser
  EXPECT_TRUE(contains(error(one, 6), "Cannot write '/proc/out.####.exr': its folder takes no new files"));
  fs::create_directory_symlink(sequence.folder / "", sequence.folder / "link");
  const std::string name = fs::path(one[1]).filename().string();
  for (const fs::path& same : {fs::path(one[1]), sequence.folder / "." / name, sequence.folder / "link" / name}) {
    one[4] = same.string();
    EXPECT_TRUE(contains(error(one, 2), "is an input, too")) << same;
  }
  const SmallFrame frame;
  EXPECT_TRUE(contains(error(frame.arguments({"--frames", "1-3"}), 2), "is for sequences"));
  Arguments many = frame.arguments();
  many[4] = (frame.folder / "out.####.exr").string();
  EXPECT_TRUE(contains(error(many, 2), "names many frames, but"));
}

}  // namespace
}  // namespace xrds::test
