#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/report.h"
#include "cli/upscale_input.h"

namespace xrds {

/// What a run computed, and how.
struct Upscaled {
  Image colour;
  float exposure = 0;
  double seconds = 0, secondsInAll = 0;
  uint64_t deviceBytes = 0, brokenPixels = 0;
  Tiling tiling{};
  SkipMap skipped{};
  UpscaledLayers layers{};
  std::vector<Upscaler::ProfileRow> profile;
  std::vector<Upscaler::CheckRow> checks;
  std::vector<MeasuredImage> measured;
};

/// What was made of layers, as lines for a terminal.
std::string layersText(const LayerList& layers);

/// One line for a terminal: the file, its size, what made it and how long that took.
std::string upscaleText(const UpscaleOptions& options, const UpscaleInput& input, const Device::Description& device,
                        const Upscaled& result);

/// The same in full as JSON, with every metric, check and profiled dispatch there is.
std::string upscaleJson(const UpscaleOptions& options, const UpscaleInput& input, const Device::Description& device,
                        const Upscaled& result);

}  // namespace xrds
