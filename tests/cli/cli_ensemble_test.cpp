// The mean of passes over a frame and its mirror images, through the command.
#include <cmath>

#include "tests/cli/frames.h"

namespace xrds::test {
namespace {

// A frame of 12 x 10 pixels of noise, or its mirror image, left to right.
struct NoisyFrame : SmallFrame {
  explicit NoisyFrame(bool isMirrored) {
    const auto noise = [=](const std::string& name, const char* channels, int width) {
      return Layer{name, channels, [=](int x, int y, int c) {
                     const int column = isMirrored ? width - 1 - x : x;
                     const int random = (column * 7919 + y * 104729 + c * 31 + column * y) % 256;
                     const bool turned = isMirrored && name == "normal" && c == 0;
                     return (turned ? -1.F : 1.F) * (0.1F + 0.9F * static_cast<float>(random) / 255);
                   }};
    };
    writeParts(color, {{boxOf(12, 10), boxOf(12, 10), {noise("", "RGB", 12)}}});
    writeParts(aux, {{boxOf(48, 40), boxOf(48, 40), {noise("albedo", "RGB", 48), noise("normal", "XYZ", 48)}}});
  }
  Image upscaled(const std::vector<std::string>& more) const {
    const Ended ended = runXrds(arguments(more));
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    return readColour(out);
  }
};

// The largest relative difference between a picture and the mirror image of the other.
double largestDifference(const Image& picture, const Image& mirrored) {
  double largest = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const double a = picture.at(x, y, c), b = mirrored.at(picture.width - 1 - x, y, c);
        largest = std::max(largest, std::abs(a - b) / (std::abs(a) + 0.01));
      }
  return largest;
}

TEST(CliEnsemble, GivesAMirroredFrameTheMirroredPicture) {
  const NoisyFrame frame(false), mirrored(true);
  EXPECT_GT(largestDifference(frame.upscaled({}), mirrored.upscaled({})), 0.01);
  EXPECT_LT(largestDifference(frame.upscaled({"--ensemble", "4"}), mirrored.upscaled({"--ensemble", "4"})), 1e-4);
  EXPECT_LT(largestDifference(frame.upscaled({"--ensemble", "8"}), mirrored.upscaled({"--ensemble", "8"})), 1e-4);
  EXPECT_GT(largestDifference(frame.upscaled({"--ensemble", "2"}), mirrored.upscaled({"--ensemble", "2"})), 1e-3);
}

TEST(CliEnsemble, TakesTilesAndSkippingAndIsNoted) {
  SmallFrame frame;
  writeHalfEvenFrame(frame.color, frame.aux, 20);
  const Ended ended = runXrds(frame.arguments({"--ensemble", "2", "--skip", "safe", "--memory", "4M"}));
  EXPECT_EQ(ended.exitCode, 0) << ended.error;
  EXPECT_NE(ended.output.find(" % of the windows skipped"), std::string::npos) << ended.output;
  const Image picture = readColour(frame.out);
  for (int y = 0; y < 280; ++y) EXPECT_NEAR(picture.at(359, y, 1), 0.4F, 1e-4F);
  EXPECT_NE(headerOf(frame.out).attributes.text("xrds:options").value_or("").find("ensemble=2 skip=safe"),
            std::string::npos);
}

TEST(CliEnsemble, RefusesOtherCounts) {
  EXPECT_EQ(runXrds(SmallFrame().arguments({"--ensemble", "3"})).exitCode, 2);
  EXPECT_EQ(runXrds(SmallFrame().arguments({"--ensemble", "8", "--wrap"})).exitCode, 2);
}

}  // namespace
}  // namespace xrds::test
