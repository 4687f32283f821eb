#pragma once

#include <cstdint>
#include <optional>

#include "xrds/xrds_report.h"

namespace xrds {

/// How a frame that does not fit into memory as a whole may be cut into tiles. Each tile is upscaled with a halo around
/// it, whose result is thrown away.
struct TileOptions {
  uint64_t memoryBytes = 0;  // of the device, for the arena and the weights; 0: three quarters of what it reports
  /// With the halo of all that the network sees, the result is that of the whole frame bit for bit. Else the halo is
  /// smaller and the work less: `xrds bench tiles` measures the error.
  bool exact = false;
  bool wrap = false;               // the left and right borders continue into each other, as in a panorama
  std::optional<uint32_t> halo{};  // low-resolution pixels, whole windows, in place of the two above
  uint32_t columns = 0, rows = 0;  // of the grid; 0: what fits the memory with the least work

  /// As the C API has them.
  void fill(XrdsUpscalerOptions& asked) const {
    asked.memoryBytes = memoryBytes;
    asked.exactTiles = exact;
    asked.wrap = wrap;
    asked.tileHalo = halo ? static_cast<int64_t>(*halo) : -1;
    asked.tileColumns = columns;
    asked.tileRows = rows;
  }
};

/// The tiles of a frame: one and no halo if the frame is taken as a whole.
struct Tiling {
  uint32_t columns = 1, rows = 1;
  uint32_t halo = 0;                         // low-resolution pixels around each tile
  uint32_t tileWidth = 0, tileHeight = 0;    // of the largest with its halo, in pixels of the output
  double work = 1;                           // pixels computed over pixels of the frame
  uint64_t arenaBytes = 0, weightBytes = 0;  // device memory

  static Tiling of(const XrdsTiling& found) {
    return {found.columns,    found.rows, found.halo,       found.tileWidth,
            found.tileHeight, found.work, found.arenaBytes, found.weightBytes};
  }
};

}  // namespace xrds
