#pragma once

#include "frames/tiles.h"
#include "frames/window_mask.h"

namespace xrds {

/// What one more tile costs besides the pixels of its crop, in low-resolution pixels: submissions and transfers.
inline constexpr double kTilePixels = 512;

/// Cuts `whole`, a tile that begins at a window's corner, down to tiles whose inner parts are disjoint and cover every
/// marked window of its inner part, at the least cost, crops and kTilePixels, that cutting it again and again from side
/// to side can reach (on a grid of at most 20 x 20 cells of whole windows). `whole` itself if that costs hardly more,
/// none if no window of it is marked. `halo`: low-resolution pixels, whole windows, around each inner part but beyond
/// the frame's border. Pure.
std::vector<Tile> coverWindows(const WindowMask& needed, FrameShape frame, const Tile& whole, uint32_t windowSize,
                               uint32_t halo);

/// The windows that lie in no tile's inner part.
WindowMask windowsOutside(std::span<const Tile> tiles, FrameShape frame, uint32_t windowSize);

}  // namespace xrds
