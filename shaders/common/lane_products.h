#pragma once

#include <algorithm>
#include <cstddef>

namespace xrds {

/// Where lane_products.glsl has the weight of a row for an output: tiles of `tile` outputs after each other, in each
/// all rows of its first eight outputs, then of the next; the last ones may be four.
inline size_t laneWeightAt(size_t output, size_t row, size_t rows, size_t tile) {
  constexpr size_t kPair = 8;
  const size_t inTile = output % tile, first = inTile / kPair * kPair;
  return (output - inTile + first) * rows + row * std::min(kPair, tile - first) + inTile - first;
}

}  // namespace xrds
