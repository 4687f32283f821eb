#pragma once

#include <algorithm>
#include <initializer_list>

#include "shaders/common/groups.h"

namespace xrds {

inline constexpr uint32_t kTileInvocations = 256;  // of a workgroup of a tile kernel

/// Whether the family's kernels are those of `tile`, with sums in fp32 or in halves.
constexpr bool isOfTiles(KernelFamily family) { return family == KernelFamily::tile || family == KernelFamily::half; }

/// Whether the device takes the tile kernels: its own family, or one of the operators without a matrix kernel.
inline bool takesTiles(const DeviceTraits& device) {
  return (isOfTiles(device.family) || usesMatrixUnits(device.family)) && device.maxGroupInvocations >= kTileInvocations;
}

/// The kernel of tiles of an operator that has both: `half` where all that it reads and writes are halves.
inline KernelFamily tileFamily(const DeviceTraits& device, std::initializer_list<DataType> types) {
  const bool areHalves = std::all_of(types.begin(), types.end(), [](DataType type) { return type == DataType::f16; });
  const bool computes = device.family == KernelFamily::half && device.addsHalves;
  return computes && areHalves ? KernelFamily::half : KernelFamily::tile;
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
