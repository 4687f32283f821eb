#pragma once

#include <string>

#include "engine/device.h"
#include "frames/session.h"
#include "xrds/xrds.hpp"

namespace xrds {

struct MemoryLimits;

struct Device::State {
  Gpu gpu;
};

struct Model::State {
  NetworkModel weights;
};

/// The tiles of a frame, given by its low-resolution shape. Throws Error if none fit or the halo is no multiple of the
/// window.
Tiling tilingOf(const NetworkModel& model, FrameShape frame, bool fp16, const TileOptions& options,
                const MemoryLimits& limits);

}  // namespace xrds
