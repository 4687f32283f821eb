#pragma once

#include "shaders/common/groups.h"

namespace xrds {

inline constexpr uint32_t kTileInvocations = 256;  // of a workgroup of a tile kernel

/// Whether the device takes the tile kernels: its own family, or one of the operators without a matrix kernel.
inline bool takesTiles(const DeviceTraits& device) {
  return (device.family == KernelFamily::tile || usesMatrixUnits(device.family)) &&
         device.maxGroupInvocations >= kTileInvocations;
}

/// Invocations side by side in a tile, each for four outputs: as many as leave at most a quarter of them idle.
inline uint32_t tileColumns(uint32_t outputQuads) {
  uint32_t columns = 16;
  while (4 * (ceilDivide(outputQuads, columns) * columns - outputQuads) > outputQuads) columns /= 2;
  return columns;
}

/// Workgroups of kernels that take output tiles along x and token tiles along y, folded into z.
inline std::array<uint32_t, 3> tileGroups(uint32_t outputTiles, uint64_t tokenTiles) {
  const std::array<uint32_t, 3> folded = foldedGroups(tokenTiles);
  return {outputTiles, folded[0], folded[1]};
}

}  // namespace xrds
