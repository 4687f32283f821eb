#pragma once

#include <string>

#include "engine/device.h"
#include "graph/session.h"
#include "xrds/xrds.h"

namespace xrds {

struct MemoryLimits;

struct Device::State {
  Gpu gpu;
};

struct Model::State {
  ModelWeights weights;
};

/// The tiles of a frame, given by its low-resolution shape. Throws Error if none fit or the halo is no multiple of the
/// window.
Tiling tilingOf(const ModelWeights& model, FrameShape frame, bool fp16, const TileOptions& options,
                const MemoryLimits& limits);

}  // namespace xrds
