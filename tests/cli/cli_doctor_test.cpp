// doctor: what it says of this device, of one that computes wrongly and of one that lacks something.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/verdict.h"
#include "tests/cli/faults.h"
#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

bool anyContains(const std::vector<std::string>& sentences, const std::string& part) {
  return std::any_of(sentences.begin(), sentences.end(), [&](const auto& s) { return contains(s, part); });
}

// A discrete device of a known driver on which everything is right.
Findings rightFindings() {
  const KernelExamination kernel{.program = "linear_plain_f32",
                                 .node = "fc",
                                 .shapes = "1x1x4 -> 1x1x4",
                                 .rms = 1e-7,
                                 .max = 1e-6,
                                 .rmsBound = 1e-5,
                                 .maxBound = 1e-4};
  const FrameExamination frame{.width = 12, .height = 10, .rms = 1e-6, .rmsBound = 1e-4};
  Findings findings{
      .device = {.name = "device", .kind = "cpu", .driver = "llvmpipe Mesa 22.3.6", .memoryBytes = 1 << 30},
      .capabilities = {.kernelFamily = "lane", .int64 = true, .timestamps = true, .maxTensorTexels = 1 << 27},
      .precisions = {{false, {kernel}, frame}, {true, {kernel}, frame}},
      .usual = UsualFrame{"model", 1920, 1080, 1 << 29, 1 << 28},
      .runs = 3};
  return findings;
}

TEST(Verdict, TrustsARightDevice) {
  const Verdict verdict = judge(rightFindings());
  EXPECT_EQ(verdict.code, ExitCode::ok);
  EXPECT_TRUE(contains(verdict.sentence, "is trusted: all 2 kernels")) << verdict.sentence;
  EXPECT_TRUE(verdict.failures.empty());
  ASSERT_EQ(verdict.degraded.size(), 1U);
  EXPECT_TRUE(contains(verdict.degraded[0], "software device"));
}

TEST(Verdict, TellsWhatIsWrong) {
  Findings wrong = rightFindings();
  wrong.precisions[0].kernels[0].rms = 0.1;
  EXPECT_EQ(judge(wrong).code, ExitCode::differs);
  EXPECT_TRUE(contains(judge(wrong).sentence, "not trusted"));
  EXPECT_TRUE(
      anyContains(judge(wrong).failures, "Kernel linear_plain_f32 (fc, 1x1x4 -> 1x1x4): relative RMS error 0.1"));

  Findings changing = rightFindings();
  changing.precisions[1].kernels[0].repeatable = false;
  EXPECT_EQ(judge(changing).code, ExitCode::differs);
  EXPECT_TRUE(contains(judge(changing).sentence, "trusted in fp32 alone"));
  EXPECT_TRUE(anyContains(judge(changing).failures, "equal runs gave different bits"));

  Findings infinite = rightFindings();
  infinite.precisions[0].frame.finite = false;
  EXPECT_TRUE(anyContains(judge(infinite).failures, "known frame in fp32: the result is not finite"));
}

TEST(Verdict, TellsWhatTheDeviceLacks) {
  Findings lesser = rightFindings();
  lesser.capabilities = {.kernelFamily = "lane"};
  lesser.device.memoryBytes = 300 << 20;
  lesser.device.driver = "unheard-of 1.0";
  const std::vector<std::string> degraded = judge(lesser).degraded;
  EXPECT_EQ(judge(lesser).code, ExitCode::ok) << "lacking something is no reason for distrust";
  for (const char* words :
       {"64-bit integers", "no timestamps", "at most 0 texels", "use --precision fp16", "unheard-of 1.0"})
    EXPECT_TRUE(anyContains(degraded, words)) << words;
}

TEST(CliDoctor, ExaminesThisDevice) {
  const TemporaryFolder out;
  const std::string json = (out / "doctor.json").string();
  const Ended ended = runXrds({"doctor", "--runs", "2", "--json", json});
  EXPECT_EQ(ended.exitCode, 0) << ended.output << ended.error;
  EXPECT_TRUE(contains(ended.output, "This device is trusted")) << ended.output;
  const auto report = nlohmann::json::parse(readBytes(json));
  EXPECT_TRUE(report["trusted"].get<bool>());
  EXPECT_GT(report["kernels"].size(), 40U);
  ASSERT_EQ(report["knownFrames"].size(), 2U);
  for (const auto& kernel : report["kernels"]) {
    EXPECT_TRUE(kernel["withinBound"].get<bool>() && kernel["repeatable"].get<bool>()) << kernel;
    EXPECT_GT(kernel["microseconds"], 0) << kernel;
  }
}

// A dispatch that never ran leaves its output unwritten. Of two in a row one is no mere compilation.
TEST(CliDoctor, DistrustsADeviceThatLosesADispatch) {
  const TemporaryFolder out;
  const std::string json = (out / "doctor.json").string();
  const Ended ended = runXrds({"doctor", "--runs", "2", "--json", json}, withFaults("vkCmdDispatch:60:2:0"));
  EXPECT_EQ(ended.exitCode, 7) << ended.output << ended.error;
  EXPECT_TRUE(contains(ended.output, "Wrong:")) << ended.output;
  EXPECT_TRUE(contains(ended.error, "This device is not trusted")) << ended.error;
  EXPECT_FALSE(nlohmann::json::parse(readBytes(json))["trusted"].get<bool>());
}

TEST(CliDoctor, ExaminesTheKernelFamilyThatTheEnvironmentNames) {
  const TemporaryFolder out;
  const std::string json = (out / "doctor.json").string();
  const StartOptions tile{.environment = {{"XRDS_KERNEL_FAMILY", "tile"}}};
  const Ended ended = runXrds({"doctor", "--runs", "2", "--json", json}, tile);
  EXPECT_EQ(ended.exitCode, 0) << ended.output << ended.error;
  const auto report = nlohmann::json::parse(readBytes(json));
  EXPECT_EQ(report["capabilities"]["kernelFamily"], "tile");
  for (const char* program :
       {"conv3x3_tile_f16", "layer_norm_tile_f32", "linear_tile_f16", "window_attention_tile_f32"})
    EXPECT_TRUE(contains(ended.output, program)) << ended.output;
  const StartOptions none{.environment = {{"XRDS_KERNEL_FAMILY", "tiles"}}};
  expectFailure(runXrds({"doctor"}, none), 2, "XRDS_KERNEL_FAMILY is 'tiles'", out, 1);
}

TEST(CliDoctor, FailsWithTheDevice) {
  const TemporaryFolder out;
  expectFailure(runXrds({"doctor", "--quiet"}, withFaults("vkQueueSubmit:5:0:-4")), 5, "the device was lost", out, 0);
  expectFailure(runXrds({"doctor", "--device", "bogus"}), 5, "bogus", out, 0);
  expectFailure(runXrds({"doctor", "--runs", "1"}), 2, "--runs", out, 0);
}

}  // namespace
}  // namespace xrds::test
