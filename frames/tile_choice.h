#pragma once

#include "frames/session.h"
#include "frames/tiles.h"
#include "frames/too_little_memory.h"

namespace xrds {

inline constexpr uint32_t kMostTiles = 256;  // in a row or column

/// What a device leaves for a run.
struct MemoryLimits {
  uint64_t byteSize = 0;  // arena and weights together
  DeviceTraits traits{};
  KernelTable kernels{};  // as in GraphOptions
  uint32_t layers = 0;    // the same
  uint32_t sharers = 1;   // frames that are ready at once, each of which takes that part of the bytes
};

/// A grid of tiles, and the device memory that it takes.
struct TileChoice {
  Cut cut;
  FrameShape crop;  // the largest
  uint64_t arenaByteSize = 0, weightByteSize = 0;
  /// Pixels of all crops over those of the frame: what the halos cost.
  double work = 1;
};

/// The grid of tiles with the least work that fits the limits: the whole frame as one tile if that does. `wanted` gives
/// halo and wrap, and columns and rows where these are not 0. Builds the graphs of a few candidates, a tenth of a
/// second each; needs no device. Throws Error if even the smallest tiles do not fit; TooLittleMemory, naming the least
/// that is needed, if that is for want of memory.
TileChoice chooseTiles(const NetworkModel& model, FrameShape frame, Precision precision, const Cut& wanted,
                       const MemoryLimits& limits);

}  // namespace xrds
