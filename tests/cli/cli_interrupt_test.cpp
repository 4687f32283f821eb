// Interrupts, on a real terminal: the bar appears, Ctrl-C ends the run, nothing stays behind.
#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

TEST(CliInterrupt, ControlCEndsARunAndLeavesNothing) {
  const SmallFrame frame;
  writeParts(frame.color, {{boxOf(256, 256), boxOf(256, 256), {colourLayer("", 256)}}});
  writeParts(frame.aux,
             {{boxOf(1024, 1024), boxOf(1024, 1024), {albedoLayer("albedo", 1024), normalLayer("normal", 1024)}}});
  const Ended ended = runOnTerminal(
      {"upscale", frame.color, frame.aux, "-o", frame.out, "--model", goldenModel("s4_guided")}, "0 %", "\x03");
  EXPECT_EQ(ended.exitCode, 130) << ended.output;
  EXPECT_NE(ended.output.find("[   "), std::string::npos) << ended.output;
  EXPECT_NE(ended.output.find("Interrupted"), std::string::npos) << ended.output;
  EXPECT_EQ(frame.folder.fileCount(), 2u);
}

TEST(CliInterrupt, TheBarIsErasedAtTheEnd) {
  const SmallFrame frame;
  const Ended ended = runOnTerminal(frame.arguments(), "", "");
  EXPECT_EQ(ended.exitCode, 0) << ended.output;
  EXPECT_NE(ended.output.find("\r\x1b[K"), std::string::npos) << ended.output;
}

}  // namespace
}  // namespace xrds::test
