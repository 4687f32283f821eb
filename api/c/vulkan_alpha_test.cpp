// The alpha of recorded frames: the same as xrdsUpscale() gives.
#include <algorithm>
#include <cmath>

#include "shaders/host_pixels/host_pixels.h"
#include "tests/embedded.h"
#include "xrds/alpha.h"

namespace xrds {
namespace {

using test::Embedded;
using test::kScale;
using test::Layout;
using test::noise;

class EmbeddedAlpha : public Embedded {
 public:
  // The last number of each pixel.
  void setAlpha(const Picture& to) const {
    for (uint32_t y = 0, i = 0; y < to.image.height; ++y)
      for (uint32_t x = 0; x < to.image.width; ++x) setNumber(to, x, y, to.layout.channels - 1, alpha()[i++]);
  }
  // A third opaque, a third transparent, the rest anything between.
  const std::vector<float>& alpha() const {
    if (alpha_.size() == size_t{width} * height) return alpha_;
    alpha_ = noise(size_t{width} * height, 7);
    for (size_t i = 0; i < alpha_.size(); ++i) {
      alpha_[i] = fromHalf(toHalf(std::min(alpha_[i], 1.F)));
      if (i % width < width / 3) alpha_[i] = 1;
      if (i % width >= width - width / 3) alpha_[i] = 0;
    }
    return alpha_;
  }
  // What xrdsUpscale() makes of it, at the format of the output.
  std::vector<float> expectedAlpha(XrdsFormat format = XRDS_FLOAT) {
    std::vector<float> four(4 * alpha().size()), output(pixels[1].size() / 3 * 4), upscaled;
    for (size_t i = 0; i < alpha().size(); ++i) {
      std::copy_n(&pixels[0][3 * i], 3, &four[4 * i]);
      four[4 * i + 3] = alpha()[i];
    }
    upscale(xrdsInterleavedImage(four.data(), XRDS_FLOAT, 4, width, height),
            xrdsInterleavedImage(output.data(), XRDS_FLOAT, 4, kScale * width, kScale * height));
    for (size_t i = 3; i < output.size(); i += 4)
      upscaled.push_back(format == XRDS_HALF ? fromHalf(toHalf(output[i])) : output[i]);
    return upscaled;
  }
  static std::vector<float> getAlpha(const Picture& from) {
    std::vector<float> values;
    for (uint32_t y = 0; y < from.image.height; ++y)
      for (uint32_t x = 0; x < from.image.width; ++x) values.push_back(number(from, x, y, 3));
    return values;
  }
  // A frame whose colour has the alpha.
  Frame frameWithAlpha(const Layout& input = {XRDS_FLOAT, 4}, const Layout& output = {XRDS_FLOAT, 4}) {
    Frame made = frame(input, output);
    setAlpha(made.colour);
    return made;
  }
  // The frame is where it stays by now.
  void runWithAlpha(Frame& frame) {
    frame.frame.alpha = &frame.frame.colour;
    run(frame);
  }

 private:
  mutable std::vector<float> alpha_;
};

TEST_F(EmbeddedAlpha, IsThatOfUpscale) {
  EXPECT_EQ(shader::kAlphaRounding, kAlphaRounding);
  const std::vector<float> colours = expected(), wanted = expectedAlpha();
  EXPECT_GT(std::count(wanted.begin(), wanted.end(), 1), 300);
  EXPECT_GT(std::count(wanted.begin(), wanted.end(), 0), 300);
  Frame mine = frameWithAlpha();
  runWithAlpha(mine);
  EXPECT_EQ(getAlpha(mine.output), wanted);
  EXPECT_EQ(get(mine.output), colours);
}

TEST_F(EmbeddedAlpha, IsTakenFromAnyLayout) {
  const Layout colours[] = {{XRDS_FLOAT, 4, 1028, 52}, {XRDS_HALF, 4, 0, 0}, {XRDS_HALF, 4, 4, 64}};
  for (const Layout& layout : colours) {
    SCOPED_TRACE(testing::Message() << layout.format << ' ' << layout.offset);
    Frame mine = frameWithAlpha(layout, layout);
    runWithAlpha(mine);
    EXPECT_EQ(getAlpha(mine.output), expectedAlpha(layout.format));
    Frame plain = frameWithAlpha(layout, layout);
    run(plain);
    EXPECT_EQ(get(mine.output), get(plain.output));
    EXPECT_EQ(number(plain.output, 30, 20, 3), 1);
  }
}

// A plane of its own, beside a colour without alpha.
TEST_F(EmbeddedAlpha, MayBeAPlane) {
  const Layout planes[] = {{XRDS_FLOAT, 1, 0, 0}, {XRDS_FLOAT, 1, 260, 8}, {XRDS_HALF, 1, 0, 0}, {XRDS_HALF, 1, 12, 4}};
  for (const Layout& layout : planes) {
    SCOPED_TRACE(testing::Message() << layout.format << ' ' << layout.offset);
    Frame mine = frame({}, {XRDS_FLOAT, 4});
    const Picture plane = picture(width, height, layout);
    setAlpha(plane);
    mine.frame.alpha = &plane.image;
    run(mine);
    EXPECT_EQ(getAlpha(mine.output), expectedAlpha());
  }
}

TEST_F(EmbeddedAlpha, GoesThroughTilesAndAroundPanoramas) {
  open(72, 40, xrdsUpscalerOptionsDefault());
  XrdsUpscalerOptions options = xrdsUpscalerOptionsDefault();
  options.tileColumns = 3;
  options.tileRows = 2;
  for (const int wrap : {0, 1}) {
    options.wrap = wrap;
    open(72, 40, options);
    Frame mine = frameWithAlpha();
    runWithAlpha(mine);
    EXPECT_EQ(getAlpha(mine.output), expectedAlpha()) << wrap;
    EXPECT_EQ(get(mine.output), expected()) << wrap;
  }
}

TEST_F(EmbeddedAlpha, RecordsWithoutAllocatingAndReplays) {
  Frame mine = frameWithAlpha();
  mine.frame.alpha = &mine.frame.colour;
  prepare(mine);
  const VkCommandBuffer commands = recordedWithoutAllocating(mine);
  for (int again = 0; again < 2; ++again) {
    std::memset(mine.output.memory.bytes, 0x5A, 4 * sizeof(float) * pixels[1].size() / 3);
    host->submit(commands);
    host->await();
    EXPECT_EQ(getAlpha(mine.output), expectedAlpha());
  }
  ASSERT_EQ(xrdsRun(mine.recording, nullptr, nullptr), XRDS_OK) << xrdsGetMessage();
  EXPECT_EQ(getAlpha(mine.output), expectedAlpha());
}

TEST_F(EmbeddedAlpha, StaysWithinItsRange) {
  Frame mine = frameWithAlpha();
  setNumber(mine.colour, 5, 4, 3, NAN);
  setNumber(mine.colour, 6, 7, 3, INFINITY);
  setNumber(mine.colour, 7, 2, 3, -3.F);
  runWithAlpha(mine);
  EXPECT_EQ(get(mine.output), expected());
  for (const float value : getAlpha(mine.output)) ASSERT_TRUE(value >= 0 && value <= 1) << value;
}

TEST_F(EmbeddedAlpha, RefusesWhatCannotBe) {
  Frame mine = frameWithAlpha();
  mine.frame.auxiliary = mine.images;
  XrdsRecording* made = nullptr;
  const auto refused = [&](XrdsVulkanFrame wrong, const XrdsVulkanImage& alpha, const char* words) {
    wrong.alpha = &alpha;
    EXPECT_EQ(xrdsCreateRecording(upscaler, &wrong, &made), XRDS_ERROR_ARGUMENT) << words;
    EXPECT_NE(std::string(xrdsGetMessage()).find(words), std::string::npos) << words << " in " << xrdsGetMessage();
  };
  XrdsVulkanImage alpha = mine.colour.image;
  alpha.channelCount = 3;
  refused(mine.frame, alpha, "The alpha image has 3 channels, expected 1 or 4");
  refused(mine.frame, mine.output.image, "The alpha image is 56 x 36 pixels, expected 14 x 9");
  alpha.structSize = 1;
  refused(mine.frame, alpha, "structSize of 1");
  XrdsVulkanFrame opaque = mine.frame;
  opaque.output.channelCount = 3;
  refused(opaque, mine.colour.image, "The output image has 3 channels, expected 4");
  EXPECT_EQ(made, nullptr);
}

// Their frames end before the alpha.
TEST_F(EmbeddedAlpha, IsOpaqueForOlderHeaders) {
  Frame mine = frameWithAlpha();
  mine.frame.structSize = offsetof(XrdsVulkanFrame, alpha);
  std::memset(&mine.frame.alpha, 0x5A, sizeof mine.frame.alpha);  // NOLINT(bugprone-sizeof-expression): all of it
  run(mine);
  EXPECT_EQ(get(mine.output), expected());
  EXPECT_EQ(getAlpha(mine.output), std::vector<float>(pixels[1].size() / 3, 1));
}

}  // namespace
}  // namespace xrds
