#pragma once

#include "tests/cli/frames.h"
#include "tests/viewer/viewer_display.h"

namespace xrds::test {

/// The viewer with a noisy frame, and networks of Open Image Denoise, small ones of random weights, for tests to
/// import.
struct ViewerDenoiser : ViewerDisplay {
  std::map<std::string, std::string> environment{{"XRDS_DENOISERS", (folder / "networks").string()}};

  // 80 x 60 pixels, and four times that with a colour of its own.
  std::string colour = (folder / "colour.exr").string(), full = (folder / "full.exr").string(),
              reference = (folder / "reference.exr").string();

  ViewerDenoiser() {
    writeParts(colour, {{boxOf(80, 60), boxOf(80, 60), {colourLayer("", 80)}}});
    writeParts(full, {{boxOf(320, 240),
                       boxOf(320, 240),
                       {colourLayer("", 320), albedoLayer("albedo", 320), normalLayer("normal", 320)}}});
    writeParts(reference, {{boxOf(320, 240), boxOf(320, 240), {colourLayer("", 320)}}});
  }
  void importNetworks() const {
    std::filesystem::create_directory(folder / "networks");
    for (const auto& [from, to] : {std::pair{"hdr_albedo_normal_large", "rt_hdr_calb_cnrm"},
                                   {"albedo_small", "rt_alb"},
                                   {"normal_small", "rt_nrm"}})
      std::filesystem::copy_file(XRDS_GOLDEN_FOLDER "/unet/" + std::string(from) + ".model.safetensors",
                                 folder / "networks" / (std::string(to) + ".safetensors"));
  }
  /// Takes the steps of a script on these files and options.
  Ended look(const std::string& script, const std::vector<std::string>& arguments) const {
    Ended ended = runViewer(desktop, folder, script, arguments, environment);
    EXPECT_EQ(ended.exitCode, 0) << ended.error;
    EXPECT_EQ(ended.error, "") << script;
    return ended;
  }
};

}  // namespace xrds::test
