#pragma once

#include <string>
#include <vector>

#include "image/exr/planes.h"
#include "image/exr/read.h"

namespace xrds {

/// The channels' names with their layer, also where that goes by the name of its part.
std::vector<std::string> outputNames(const ExrFile& file, const ExrSelection& layer);

/// What the output has beside copies, and what is no copy.
struct MadeLayers {
  std::vector<std::string> channels{};  // of the output
  std::vector<ExrSelection> sources{};  // layers of the file that are read for them
  std::vector<std::string> lights{};    // own names of lights of the colour's render that nobody asked for
};

/// Layers as a file stores them.
struct CopiedLayers {
  std::vector<ExrPlane> planes;
  std::vector<std::string> names, leftOut;  // left out: some of them with their reason, "A, B (...)"
  std::vector<ExrAttributes> attributes{};  // of the parts that they are of
};

/// Reads every channel over `window`, bit for bit, that is not of a colour, of light or made otherwise: depth, normals,
/// ids, Cryptomatte, colour passes, what a renderer adds; of all parts with the data window of `part`, of the default
/// view. Throws Error if the file cannot be read.
CopiedLayers copyLayers(const ExrFile& file, size_t part, const Box& window, const MadeLayers& made);

}  // namespace xrds
