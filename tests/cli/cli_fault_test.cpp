// A device or disk that fails half-way: the run goes on elsewhere or smaller, or ends with its exit code. Never a wrong
// or partial image.
#include <vulkan/vulkan_core.h>

#include "tests/cli/faults.h"
#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

std::string rule(const std::string& function, unsigned first, unsigned count, VkResult result) {
  return function + ":" + std::to_string(first) + ":" + std::to_string(count) + ":" + std::to_string(result);
}

std::string goodPicture(const SmallFrame& frame) {
  EXPECT_EQ(runXrds(frame.arguments()).exitCode, 0);
  const std::string bytes = readBytes(frame.out);
  std::filesystem::remove(frame.out);
  return bytes;
}

TEST(CliFault, ADeviceThatFailsEndsTheRunWithItsExitCode) {
  const SmallFrame frame;
  static_cast<void>(goodPicture(frame));  // compiles the programs, so that calls come in the same order
  const auto fails = [&](const std::string& rules, const std::string& words) {
    expectFailure(runXrds(frame.arguments({"--quiet"}), withFaults(rules)), 5, words, frame.folder, 2);
  };
  fails(rule("vkQueueSubmit", 1, 0, VK_ERROR_DEVICE_LOST), "the device was lost");
  fails(rule("vkQueueSubmit", 2, 0, VK_ERROR_DEVICE_LOST), "choose another device");
  fails(rule("vkWaitForFences", 1, 0, VK_ERROR_DEVICE_LOST), "the device was lost");
  fails(rule("vkWaitForFences", 3, 0, VK_TIMEOUT), "did not finish within minutes");
  fails(rule("vkAllocateMemory", 1, 0, VK_ERROR_OUT_OF_DEVICE_MEMORY), "has no room for a buffer");
  fails(rule("vkCreateComputePipelines", 1, 0, VK_ERROR_OUT_OF_HOST_MEMORY), "out of host memory");
  fails(rule("vkCreateDevice", 1, 0, VK_ERROR_INITIALIZATION_FAILED), "the driver could not start");
}

TEST(CliFault, TooLittleMemoryMakesTheRunSmaller) {
  const SmallFrame frame;
  const std::string good = goodPicture(frame);
  const auto log = frame.folder / "faults";
  const Ended ended =
      runXrds(frame.arguments(), withFaults(rule("vkAllocateMemory", 1, 1, VK_ERROR_OUT_OF_DEVICE_MEMORY), log));
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(readBytes(log), "vkAllocateMemory\n");
  EXPECT_EQ(readColour(frame.out), [&] {
    writeBytes(frame.folder / "good.exr", good);
    return readColour((frame.folder / "good.exr").string());
  }());
}

// The work that was waited for goes on: its memory must not be freed.
TEST(CliFault, AWaitThatLacksMemoryIsWaitedAgain) {
  const SmallFrame frame;
  const std::string good = goodPicture(frame);
  const auto log = frame.folder / "faults";
  for (const unsigned call : {1u, 3u}) {
    std::filesystem::remove(log);
    const Ended ended =
        runXrds(frame.arguments(), withFaults(rule("vkWaitForFences", call, 1, VK_ERROR_OUT_OF_HOST_MEMORY), log));
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_EQ(readBytes(log), "vkWaitForFences\n");
    EXPECT_EQ(readBytes(frame.out), good);
  }
}

TEST(CliFault, AnotherDeviceGoesOnWhereOneFails) {
  const SmallFrame frame;
  const TemporaryFolder drivers;
  const std::string good = goodPicture(frame);
  StartOptions lost = withFaults(rule("vkQueueSubmit", 1, 1, VK_ERROR_DEVICE_LOST));
  if (!addSecondDevice(lost, drivers / "")) GTEST_SKIP() << "lavapipe is not installed where it usually is";
  const Ended ended = runXrds(frame.arguments(), lost);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_NE(ended.error.find("warning: device 0"), std::string::npos) << ended.error;
  EXPECT_NE(ended.error.find("continuing on device 1"), std::string::npos) << ended.error;
  EXPECT_EQ(readBytes(frame.out), good);
  std::filesystem::remove(frame.out);
  expectFailure(runXrds(frame.arguments({"--device", "0", "--quiet"}), lost), 5, "the device was lost", frame.folder,
                2);
}

// As MoltenVK's on macOS: the loader shows such drivers only to programs that ask for them.
TEST(CliFault, ADriverThatLacksPartsOfVulkanIsFoundAndOpened) {
  const SmallFrame frame;
  const TemporaryFolder drivers;
  const std::string good = goodPicture(frame);
  StartOptions options = withFaults("portability:1:0:0", drivers / "log");
  if (!makePortabilityDriver(options, drivers / "")) GTEST_SKIP() << "lavapipe is not installed where it usually is";
  const Ended ended = runXrds(frame.arguments(), options);
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_EQ(readBytes(drivers / "log"), "portability\n");  // the layer was asked
  EXPECT_EQ(readBytes(frame.out), good);
}

// Whichever call fails, first among hundreds or late.
TEST(CliFault, NoFailedCallLeavesAWrongPicture) {
  const SmallFrame frame;
  const TemporaryFolder logs;
  const std::string good = goodPicture(frame);
  int failed = 0;
  for (unsigned call = 1; call < 100000; call += 1 + call / 2) {
    const auto log = logs / std::to_string(call);
    const VkResult result = call % 2 ? VK_ERROR_DEVICE_LOST : VK_ERROR_OUT_OF_DEVICE_MEMORY;
    const Ended ended = runXrds(frame.arguments({"--quiet"}), withFaults(rule("any", call, 1, result), log));
    if (!std::filesystem::exists(log)) break;
    ++failed;
    if (ended.exitCode == 0)
      EXPECT_EQ(readBytes(frame.out), good) << "call " << call << ", " << readBytes(log);
    else
      expectFailure(ended, 5, "", frame.folder, 2);
    std::filesystem::remove(frame.out);
  }
  EXPECT_GT(failed, 8);
}

TEST(CliFault, AKilledRunLeavesNoPicture) {
  const SmallFrame frame;
  const std::string older = goodPicture(frame);
  writeParts(frame.color, {{boxOf(160, 160), boxOf(160, 160), {colourLayer("", 160)}}});
  writeParts(frame.aux, {{boxOf(640, 640), boxOf(640, 640), {albedoLayer("albedo", 640), normalLayer("normal", 640)}}});
  const auto writing = [&] {  // the temporary file has pixels in it
    for (const auto& entry : std::filesystem::directory_iterator(frame.folder / "")) {
      std::error_code gone;
      if (entry.path().extension() == ".part" && entry.file_size(gone) > 1000 && !gone) return true;
    }
    return false;
  };
  constexpr int kKilled = 1000 + 9;
  int exitCode = 0;
  for (int attempt = 0; attempt < 3 && exitCode != kKilled; ++attempt) {  // the writing takes a moment only
    writeBytes(frame.out, older);
    exitCode = killXrds(frame.arguments(), writing).exitCode;
  }
  ASSERT_EQ(exitCode, kKilled);
  EXPECT_EQ(readBytes(frame.out), older);
}

TEST(CliFault, AFullStandardOutputIsAFailure) {
  const SmallFrame frame;
  StartOptions full;
  full.fullOutput = true;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"compare", frame.color, frame.color}, {"--help"}, {"info", "--help"}, {"--version"}})
    expectFailure(runXrds(words, full), 6, "standard output", frame.folder, 2);
}

}  // namespace
}  // namespace xrds::test
