#pragma once

#include "engine/recording.h"
#include "frames/frame_input.h"

namespace xrds {

/// The automatic exposure of shaders/exposure over the whole image, on the device: bit for bit what the graph of the
/// untiled frame computes. Overwrites `scratch`; if that does not hold the image, 16 bytes a pixel and some more, or
/// the device cannot bind so many pixels, the host computes it in double precision. Throws Error if the device fails.
FrameExposure exposureOf(Gpu& gpu, const PixelView& colour, Buffer& scratch);

/// The same in double precision on the host: equal to it within rounding.
FrameExposure exposureOnHost(const PixelView& colour);

/// That of denoisers (takesBinnedExposure()): 0.18 over the geometric mean of the luminances of bins of about 16 x 16
/// pixels, those at most 1e-8 left out; 1 if there is none. In double precision on the host.
FrameExposure binnedExposure(const PixelView& colour);

}  // namespace xrds
