#pragma once

#include <cstddef>

#include "image/image.h"

namespace xrds {

/// How many pixels a repair has changed.
struct RepairCounts {
  size_t nonFinitePixels = 0;
  size_t negativePixels = 0;

  bool operator==(const RepairCounts&) const = default;
};

/// Replaces every pixel that has a NaN or an infinity in any channel by the mean of its finite 8-neighbours, ring by
/// ring from the rim of a hole to its middle; an image without one finite pixel becomes zero. For albedo and normals.
RepairCounts repairNonFinite(Image& image);

/// Repairs linear radiance: non-finite pixels as above, and negative values to 0 (a pixel counts once). Highlights are
/// left as they are, however bright.
RepairCounts repairRadiance(Image& image);

}  // namespace xrds
