#pragma once

#include <string>
#include <vector>

#include "image/exr_planes.h"
#include "image/exr_read.h"

namespace xrds {

/// The channels' names with their layer, also where that goes by the name of its part.
std::vector<std::string> outputNames(const ExrFile& file, const ExrSelection& layer);

/// Layers as a file stores them.
struct CopiedLayers {
  std::vector<ExrPlane> planes;
  std::vector<std::string> names, leftOut;  // left out: with the reason
};

/// Reads every layer that is neither colour nor light over `window`, bit for bit: depth, normals, ids, Cryptomatte,
/// what a renderer adds; of all parts of the size of `part`, of the default view. `upscaled`: names of layers that are
/// made otherwise. Throws Error if the file cannot be read.
CopiedLayers copyLayers(const ExrFile& file, size_t part, const Box& window, const std::vector<std::string>& upscaled);

}  // namespace xrds
