#pragma once

#include <vector>

#include "network/frame_shape.h"

namespace xrds {

/// Pixels of the low-resolution frame. x may be negative or run past the frame where the frame continues into itself
/// horizontally.
struct Rectangle {
  int32_t x = 0;
  uint32_t y = 0, width = 0, height = 0;
  bool operator==(const Rectangle&) const = default;
};

/// A part of the frame that is upscaled on its own: the network runs on `crop`, of whose result `inner` is kept. Both
/// begin at multiples of the attention window; so do their ends, but for those at the frame's border.
struct Tile {
  Rectangle crop, inner;
  bool operator==(const Tile&) const = default;
};

/// How a frame is cut: a grid of that many tiles, with `halo` low-resolution pixels, whole windows, around each inner
/// part but beyond the frame's border. With `wrap` the left and right borders continue into each other.
struct Cut {
  uint32_t columns = 1, rows = 1, halo = 0;
  bool wrap = false;
};

/// The tiles of a frame from left to right and top to bottom; their inner parts cover it once. All crops are of one
/// size, but for the last in a row or column, which may be smaller by less than a window. Fewer tiles than asked for
/// where so many of whole windows do not fit. Pure. Throws std::logic_error if the halo is no multiple of the window.
std::vector<Tile> cutFrame(FrameShape frame, uint32_t window, const Cut& cut);

}  // namespace xrds
