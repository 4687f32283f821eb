#pragma once

#include "network/network_model.h"
#include "xrds/model.h"

namespace xrds {

struct MemoryLimits;

/// What Model of the public API does, on the network's own.
NetworkModel untrainedModel(uint32_t scale, const std::string& base, const std::string& transfer);
std::string hashText(const NetworkModel& model);
Model::Cost costOf(const NetworkModel& model, uint32_t outputWidth, uint32_t outputHeight, bool fp16,
                   const std::string& kernelFamily);
Tiling planTiles(const NetworkModel& model, uint32_t outputWidth, uint32_t outputHeight, bool fp16,
                 const TileOptions& options, const std::string& kernelFamily);

/// The tiles of a frame, given by its low-resolution shape. Throws Error if none fit or the halo is no multiple of the
/// window.
Tiling tilingOf(const NetworkModel& model, FrameShape frame, bool fp16, const TileOptions& options,
                const MemoryLimits& limits);

}  // namespace xrds
