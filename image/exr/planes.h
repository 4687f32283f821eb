#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "image/box.h"
#include "image/exr/file.h"
#include "image/image.h"

namespace xrds {

/// One channel as a file stores it.
struct ExrPlane {
  std::string name;  ///< In the file, with its layer.
  ExrPixelType type = ExrPixelType::kFloat;
  std::vector<std::byte> bytes;  ///< Numbers of that type, rows from top to bottom.
};

size_t byteSize(ExrPixelType type);

/// Reads channels of one part bit for bit, as their own type, over `window`; where the part has no pixels they are 0.
/// Throws Error when there is no such channel, it is subsampled, or the file is damaged. Safe in several threads.
std::vector<ExrPlane> readPlanes(const ExrFile& file, size_t part, const std::vector<std::string>& channelNames,
                                 const Box& window);

/// The channels of an image under these names. Halves are rounded, finite ones to the largest half at most.
std::vector<ExrPlane> planesOf(const Image& image, const std::vector<std::string>& names, ExrPixelType type);

}  // namespace xrds
