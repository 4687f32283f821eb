#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "xrds/export.h"
#include "xrds/pixel_view.h"

namespace xrds {

/// How an image is mirrored: first on its diagonal, so that rows become columns, then left to right and upside down,
/// both of which are half a turn.
struct Mirror {
  bool leftRight = false, upsideDown = false, transposed = false;
};

/// The mirrors of an ensemble of 1, 2, 4 or 8 passes, those on the diagonal first, the image as it is last. Throws
/// Error for other counts.
XRDS_API std::span<const Mirror> mirrorsOf(uint32_t passes);

/// The mirrored image, three floats a pixel. The components of a normal turn along: x points right, y up.
XRDS_API std::vector<float> mirrored(const PixelView& image, Mirror mirror, bool isNormal);

/// A pixel of a mirrored image of that size, row by row from 0, in the image as it is.
XRDS_API uint64_t mirroredPixel(uint64_t pixel, uint32_t width, uint32_t height, Mirror mirror);

}  // namespace xrds
