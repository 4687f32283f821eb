#pragma once

#include "image/image.h"
#include "xrds/alpha.h"

namespace xrds {

/// Alpha [h, w, 1] enlarged bicubically to [scale h, scale w, 1], wrapped and in tiles like the colour, and kept within
/// [0, 1]: no model is trained for it. The upscaler must be of this size and scale. Throws Error, and Failure when
/// interrupted.
Image upscaleAlpha(AlphaUpscaler& upscaler, const Image& alpha, int scale);

/// R, G, B and A of one size as one image of four channels.
Image withAlpha(const Image& colour, const Image& alpha);

}  // namespace xrds
