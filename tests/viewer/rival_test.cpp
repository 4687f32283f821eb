// The full-resolution render denoised, as a view beside xrds: by small networks of random weights.
#include "image/exr/read.h"
#include "tests/viewer/viewer_denoiser.h"

namespace xrds::test {
namespace {

using ViewerRival = ViewerDenoiser;

// The pixels are those of `xrds denoise`, and it is measured against the reference as others are.
TEST_F(ViewerRival, IsTheRenderThatXrdsDenoiseMakes) {
  importNetworks();
  const std::string clean = (folder / "clean.exr").string();
  const Ended denoised = runXrds({"denoise", full, "-o", clean}, {.environment = environment});
  ASSERT_EQ(denoised.exitCode, 0) << denoised.error;
  const Ended ended =
      look("wait\nprint\nkey W\nkey J\nmove 150 130\nwait\nprint\nscreenshot rival.png\nkey J\nwait\nprint\n",
           smallDisplay({colour, full, "--reference", reference}));
  const std::regex place(" denoised@([0-9]+),([0-9]+)=");
  std::smatch at;
  ASSERT_TRUE(std::regex_search(ended.output, at, place)) << ended.output;
  const auto pixel = printedOf(ended.output, "denoised").at(0);
  const Image expected = readColour(clean);
  for (int c = 0; c < 3; ++c) {
    const double value = expected.at(std::stoi(at[1]), std::stoi(at[2]), c);
    EXPECT_NEAR(pixel[static_cast<size_t>(c)] / value, 1, 1e-3) << c;  // printed with four digits
  }
  EXPECT_EQ(valuesOf(ended.output, "compared"), (std::vector<double>{1, 2, 2}));
  const Image shot = readPng(folder / "rival.png");
  EXPECT_GT(meanDifference(cropped(shot, 72, 74, 100, 100), Image(100, 100, 3)), 5);
}

TEST_F(ViewerRival, NeedsNetworksAndAFullResolutionColour) {
  const Ended missing = look("key J\nwait\nprint\n", smallDisplay({colour, full}));
  EXPECT_EQ(occurrences(missing.output, "read them once out of your own copy with 'xrds import oidn PATH'"), 1U)
      << missing.output;
  importNetworks();
  const Ended alone = look("key J\nwait\nprint\n", smallDisplay({kColour, kAuxiliary}));
  EXPECT_EQ(occurrences(alone.output, "The files hold no full-resolution colour to denoise."), 1U) << alone.output;
}

}  // namespace
}  // namespace xrds::test
