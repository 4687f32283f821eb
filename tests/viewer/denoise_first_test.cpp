// Frames that Open Image Denoise's networks take the noise out of before they are upscaled: small networks of random
// weights.
#include "image/exr/read.h"
#include "tests/viewer/viewer_denoiser.h"

namespace xrds::test {
namespace {

struct ViewerDenoiseFirst : ViewerDenoiser {
  ViewerDenoiseFirst() { write(20, 12); }  // so small a frame is made ready soonest
  // What `xrds upscale --denoise-first` makes of the frame.
  Image upscaled(const std::string& model, std::vector<std::string> more = {}) const {
    const std::string output = (folder / "upscaled.exr").string();
    more.insert(more.begin(), {"upscale", colour, full, "-o", output, "--model", model, "--denoise-first"});
    const Ended ended = runXrds(more, {.environment = environment});
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    return readColour(output);
  }
};

// A model that takes the full-resolution colour, too, which goes to the denoiser at the level of the merged one.
TEST_F(ViewerDenoiseFirst, TheKeyMakesThePictureOfTheCommand) {
  importNetworks();
  const std::string model = "xrds-x4-full";
  const Ended ended =
      look("wait\nsave plain.exr\nprint\nkey B\nwait\nsave denoised.exr\nwait\nprint\nkey B\nwait\nprint\n",
           {colour, full, "--model", model});
  EXPECT_EQ(occurrences(ended.output, "denoised-by=\"rt_hdr_calb_cnrm\""), 1U) << ended.output;
  const Image denoised = readColour(folder / "denoised.exr");
  EXPECT_LT(meanDifference(denoised, upscaled(model)), 1e-6);
  EXPECT_GT(meanDifference(denoised, readColour(folder / "plain.exr")), 1e-3);
}

TEST_F(ViewerDenoiseFirst, CleanGuidesStayAsTheyAre) {
  importNetworks();
  look("wait\nsave clean.exr\nwait\n", {colour, full, "--model", "xrds-x4-mini", "--denoise-first", "--clean-guides"});
  const Image clean = readColour(folder / "clean.exr");
  EXPECT_LT(meanDifference(clean, upscaled("xrds-x4-mini", {"--clean-guides"})), 1e-6);
  EXPECT_GT(meanDifference(clean, upscaled("xrds-x4-mini")), 1e-4);
}

// Then the networks run one after the other.
TEST_F(ViewerDenoiseFirst, GoesWithEnsemblesPanoramasAndSkipping) {
  importNetworks();
  const std::string model = "xrds-x4-nano", whole = "xrds-x4-full";
  Image plain = upscaled(model);
  const auto expectSame = [&](const std::string& of, const std::vector<std::string>& more) {
    std::vector<std::string> options{colour, full, "--model", of, "--denoise-first"};
    options.insert(options.end(), more.begin(), more.end());
    const Ended ended = look("wait\nsave viewed.exr\nwait\nprint\n", options);
    EXPECT_EQ(occurrences(ended.output, "denoised-by=\"rt_hdr_calb_cnrm\""), 1U) << ended.output;
    const Image viewed = readColour(folder / "viewed.exr");
    EXPECT_EQ(viewed, upscaled(of, more));
    EXPECT_NE(viewed, plain);
  };
  expectSame(model, {"--ensemble", "2"});
  expectSame(model, {"--wrap"});
  expectSame(whole, {"--ensemble", "2"});
  write(80, 60);  // in which some windows are skipped
  plain = upscaled(model);
  expectSame(model, {"--skip", "0.05"});
}

TEST_F(ViewerDenoiseFirst, MissingNetworksAreTold) {
  const Ended missing = look("key B\nwait\nprint\nkey B\nwait\nprint\n", smallDisplay({colour, full}));
  EXPECT_EQ(occurrences(missing.output, "read them once out of your own copy with 'xrds import oidn PATH'"), 1U)
      << missing.output;
}

TEST_F(ViewerDenoiseFirst, GoesWithALiveView) {
  importNetworks();
  const Ended ended =
      look("wait\nprint\ntimes\n", {"--live", "room", "--live-size", "16x16", "--samples", "3", "--denoise-first"});
  EXPECT_EQ(occurrences(ended.output, "denoised-by=\"rt_hdr_calb_cnrm\""), 1U) << ended.output;
  EXPECT_GT(valuesOf(ended.output, "part-denoisers").at(0), 0) << ended.output;
}

}  // namespace
}  // namespace xrds::test
