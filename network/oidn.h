#pragma once

#include "network/config.h"

namespace xrds {

/// Whether the model sees radiance times the exposure of binnedExposure() (frames/frame_exposure.h).
bool takesBinnedExposure(const NetworkConfig& config);

}  // namespace xrds
