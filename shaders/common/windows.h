#pragma once

#include <algorithm>

#include "engine/dispatch.h"

namespace xrds {

/// The windows of attention: squares of tokens of an image that is shifted cyclically, so that its position (y, x) is
/// pixel (y + shift, x + shift). Tokens of a window are counted row by row.
struct Windows {
  uint32_t side = 8, shift = 0;

  /// The row of a table of biases, [(2 side - 1)^2][heads], for two tokens of a window.
  uint32_t relativePosition(uint32_t query, uint32_t key) const {
    return (query / side + side - 1 - key / side) * (2 * side - 1) + query % side + side - 1 - key % side;
  }
  /// Which of the bands that the shift keeps apart a position along a side of the shifted image lies in.
  uint32_t region(uint32_t position, uint32_t size) const {
    return (position >= size - side) + (position >= size - shift);
  }
  /// How many kinds of windows there are: without and with a seam of the image in x (1), in y (2).
  uint32_t classCount() const { return shift == 0 ? 1 : 4; }
  /// Whether a seam parts two tokens of a window of that class, as region() does.
  bool isParted(uint32_t query, uint32_t key, uint32_t windowClass) const {
    const uint32_t edge = side - shift;
    return ((windowClass & 1) && (query % side >= edge) != (key % side >= edge)) ||
           ((windowClass & 2) && (query / side >= edge) != (key / side >= edge));
  }

  /// Rows of windows that meet the image's rows: contiguous and cyclic in the shifted image.
  struct Rows {
    uint32_t first = 0, count = 0;
  };
  Rows rowsThatMeet(RowRange rows, uint32_t height) const {
    const uint32_t begin = (rows.begin + height - shift) % height;
    return {begin / side, std::min(ceilDivide(begin % side + rows.end - rows.begin, side), height / side)};
  }
};

}  // namespace xrds
