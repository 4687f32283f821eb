#pragma once

#include <string>

#include "network/config.h"

namespace xrds {

/// Whether the model sees radiance times the exposure of binnedExposure() (frames/frame_exposure.h).
bool takesBinnedExposure(const NetworkConfig& config);

/// What a denoiser takes the noise out of: "hdr" or "ldr", colours; "albedo"; "normal". Empty of other networks.
std::string denoisedImage(const NetworkConfig& config);

}  // namespace xrds
