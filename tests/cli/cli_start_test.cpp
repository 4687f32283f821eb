// The first start on a machine: nothing is cached, and what is kept must have a place.
#include <algorithm>
#include <fstream>

#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

// A frame beyond Upscaler::kSmallFrame, whose kernels take long to compile.
std::vector<std::string> largerFrame(const SmallFrame& frame) {
  writeParts(frame.color, {{boxOf(32, 32), boxOf(32, 32), {colourLayer("", 32)}}});
  writeParts(frame.aux, {{boxOf(128, 128), boxOf(128, 128), {albedoLayer("albedo", 128), normalLayer("normal", 128)}}});
  return frame.arguments();
}

StartOptions cachesIn(const std::string& folder, const std::string& temporary = "") {
  StartOptions options{.environment = {{"XDG_CACHE_HOME", folder}, {"MESA_SHADER_CACHE_DIR", ""}}};
  if (!temporary.empty()) options.environment["TMPDIR"] = temporary;
  return options;
}

TEST(CliStart, AColdStartSaysWhatItCompiles) {
  const SmallFrame frame;
  const StartOptions cold = cachesIn((frame.folder / "cache").string());
  const Ended ended = runXrds(largerFrame(frame), cold);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_NE(ended.error.find("xrds: compiling programs for this device, kept for the next start: "), std::string::npos)
      << ended.error;
  auto quiet = largerFrame(frame);
  quiet.emplace_back("--quiet");
  const Ended silent = runXrds(quiet, cachesIn((frame.folder / "other").string()));
  EXPECT_EQ(silent.error, "");
}

TEST(CliStart, ControlCWhileCompilingEndsWithoutTheRest) {
  const SmallFrame frame;
  const Ended ended =
      runOnTerminal(largerFrame(frame), "compiling programs", "\x03", cachesIn((frame.folder / "cache").string()));
  EXPECT_EQ(ended.exitCode, 130) << ended.output;
  EXPECT_NE(ended.output.find("Interrupted"), std::string::npos) << ended.output;
  EXPECT_EQ(ended.output.find(" %"), std::string::npos) << "the bar, after all programs: " << ended.output;
  EXPECT_FALSE(std::filesystem::exists(frame.out));
}

TEST(CliStart, ControlCWhileCompilingInASequenceIsNoFailureOfTheDevice) {
  const SmallFrame frame;
  largerFrame(frame);
  for (int number = 1; number <= 3; ++number) {
    std::filesystem::copy_file(frame.color, frame.folder / ("c" + std::to_string(number) + ".exr"));
    std::filesystem::copy_file(frame.aux, frame.folder / ("a" + std::to_string(number) + ".exr"));
  }
  const auto in = [&](const char* name) { return (frame.folder / name).string(); };
  auto options = cachesIn(in("cache"));
  const Ended ended = runOnTerminal({"upscale", in("c#.exr"), in("a#.exr"), "-o", in("out/f#.exr"), "--model",
                                     goldenModel("s4_guided"), "--frames", "1-3"},
                                    "compiling programs", "\x03", options);
  EXPECT_EQ(ended.exitCode, 130) << ended.output;
  EXPECT_EQ(ended.output.find("failed"), std::string::npos) << ended.output;
  EXPECT_NE(ended.output.find("Interrupted"), std::string::npos) << ended.output;
}

TEST(CliStart, ACacheFolderThatCannotBeWrittenIsNamedOnceAndReplaced) {
  const SmallFrame frame;
  std::ofstream(frame.folder / "file") << "no folder";
  std::filesystem::create_directory(frame.folder / "temporary");
  const std::string place = (frame.folder / "file").string();
  const StartOptions options = cachesIn(place, (frame.folder / "temporary").string());
  const Ended first = runXrds(frame.arguments(), options);
  EXPECT_EQ(first.exitCode, 0) << first.error;
  const size_t named = first.error.find("xrds: warning: the cache folder '" + place);
  ASSERT_NE(named, std::string::npos) << first.error;
  EXPECT_EQ(first.error.find("the cache folder", named + 30), std::string::npos) << first.error;
  const Ended second = runOnTerminal(frame.arguments(), "", "", options);
  EXPECT_EQ(second.exitCode, 0) << second.output;
  EXPECT_NE(second.output.find("the cache folder '" + place), std::string::npos) << second.output;
  EXPECT_EQ(second.output.find("compiling programs"), std::string::npos) << second.output;
}

// Neither is a file begun that has no room, nor does the driver tell the same again.
TEST(CliStart, WithoutAnyCacheFolderOneWarningTellsIt) {
  const SmallFrame frame;
  std::ofstream(frame.folder / "file") << "no folder";
  StartOptions options = cachesIn((frame.folder / "file").string(), "/proc");
  options.environment["LP_NATIVE_VECTOR_WIDTH"] = "128";  // with a shader cache that xrds places, on every processor
  const Ended ended = runXrds(frame.arguments({"--quiet"}), options);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_TRUE(ended.error.starts_with("xrds: warning: the cache folder '")) << ended.error;
  EXPECT_TRUE(contains(ended.error, "programs are compiled again at every start")) << ended.error;
  EXPECT_EQ(std::count(ended.error.begin(), ended.error.end(), '\n'), 1) << ended.error;
}

TEST(CliStart, ARelativeFolderOfTheEnvironmentIsIgnored) {
  const SmallFrame frame;
  StartOptions options = cachesIn("relative");
  options.environment["HOME"] = (frame.folder / "home").string();
  options.folder = frame.folder / "";
  EXPECT_EQ(runXrds(frame.arguments(), options).exitCode, 0);
  EXPECT_FALSE(std::filesystem::exists(frame.folder / "relative" / "xrds"));
  EXPECT_TRUE(std::filesystem::exists(frame.folder / "home" / ".cache" / "xrds"));
}

// Kernels that take the driver a second to read are for frames that take longer.
TEST(CliStart, ASmallFrameTakesPlainKernels) {
  const SmallFrame frame;
  const Ended small = runXrds(frame.arguments({"--profile"}));
  EXPECT_EQ(small.exitCode, 0) << small.error;
  EXPECT_NE(small.output.find("conv3x3"), std::string::npos) << small.output;
  EXPECT_EQ(small.output.find("_lane"), std::string::npos) << small.output;
  StartOptions asked;
  asked.environment["XRDS_KERNEL_FAMILY"] = "lane";
  EXPECT_NE(runXrds(frame.arguments({"--profile"}), asked).output.find("_lane"), std::string::npos);
  largerFrame(frame);
  EXPECT_NE(runXrds(frame.arguments({"--profile"})).output.find("_lane"), std::string::npos);
}

}  // namespace
}  // namespace xrds::test
