// The full-resolution render denoised, as a view beside xrds: by small networks of random weights.
#include "image/exr_read.h"
#include "tests/cli/frames.h"
#include "tests/viewer/viewer_display.h"

namespace xrds::test {
namespace {

namespace fs = std::filesystem;

struct ViewerRival : ViewerDisplay {
  std::map<std::string, std::string> environment{{"XRDS_DENOISERS", (folder / "networks").string()}};

  // 80 x 60 pixels, and four times that with a colour of its own.
  std::string colour = (folder / "colour.exr").string(), full = (folder / "full.exr").string(),
              reference = (folder / "reference.exr").string();

  ViewerRival() {
    writeParts(colour, {{boxOf(80, 60), boxOf(80, 60), {colourLayer("", 80)}}});
    writeParts(full, {{boxOf(320, 240),
                       boxOf(320, 240),
                       {colourLayer("", 320), albedoLayer("albedo", 320), normalLayer("normal", 320)}}});
    writeParts(reference, {{boxOf(320, 240), boxOf(320, 240), {colourLayer("", 320)}}});
  }
  void importNetworks() const {
    fs::create_directory(folder / "networks");
    for (const auto& [from, to] : {std::pair{"hdr_albedo_normal_large", "rt_hdr_calb_cnrm"},
                                   {"albedo_small", "rt_alb"},
                                   {"normal_small", "rt_nrm"}})
      fs::copy_file(XRDS_GOLDEN_FOLDER "/unet/" + std::string(from) + ".model.safetensors",
                    folder / "networks" / (std::string(to) + ".safetensors"));
  }
  Ended look(const std::string& script, const std::vector<std::string>& files) const {
    Ended ended = runViewer(desktop, folder, script, smallDisplay(files), environment);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_EQ(ended.error, "") << script;
    return ended;
  }
};

// The pixels are those of `xrds denoise`, and it is measured against the reference as others are.
TEST_F(ViewerRival, IsTheRenderThatXrdsDenoiseMakes) {
  importNetworks();
  const std::string clean = (folder / "clean.exr").string();
  const Ended denoised = runXrds({"denoise", full, "-o", clean}, {.environment = environment});
  ASSERT_EQ(denoised.exitCode, 0) << denoised.error;
  const Ended ended =
      look("wait\nprint\nkey W\nkey J\nmove 150 130\nwait\nprint\nscreenshot rival.png\nkey J\nwait\nprint\n",
           {colour, full, "--reference", reference});
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
  const Ended missing = look("key J\nwait\nprint\n", {colour, full});
  EXPECT_EQ(occurrences(missing.output, "read them once out of your own copy with 'xrds import oidn PATH'"), 1U)
      << missing.output;
  importNetworks();
  const Ended alone = look("key J\nwait\nprint\n", {kColour, kAuxiliary});
  EXPECT_EQ(occurrences(alone.output, "The files hold no full-resolution colour to denoise."), 1U) << alone.output;
}

}  // namespace
}  // namespace xrds::test
