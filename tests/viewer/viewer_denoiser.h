#pragma once

#include "tests/cli/frames.h"
#include "tests/viewer/viewer_display.h"

namespace xrds::test {

/// The viewer with a noisy frame, and networks of Open Image Denoise, small ones of random weights, for tests to
/// import.
struct ViewerDenoiser : ViewerDisplay {
  std::map<std::string, std::string> environment{{"XRDS_DENOISERS", (folder / "networks").string()}};

  // A render, and one four times as large with a colour of its own.
  std::string colour = (folder / "colour.exr").string(), full = (folder / "full.exr").string(),
              reference = (folder / "reference.exr").string();

  ViewerDenoiser() { write(80, 60); }
  void write(int width, int height) const {
    const Box low = boxOf(width, height), high = boxOf(4 * width, 4 * height);
    const Layer light = colourLayer("", 4 * width);
    writeParts(colour, {{low, low, {colourLayer("", width)}}});
    writeParts(full, {{high, high, {light, albedoLayer("albedo", 4 * width), normalLayer("normal", 4 * width)}}});
    writeParts(reference, {{high, high, {light}}});
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
