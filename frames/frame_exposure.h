#pragma once

#include "engine/recording.h"
#include "xrds/pixel_view.h"

namespace xrds {

/// The exposure of a frame and its inverse, each as it was computed.
struct FrameExposure {
  float value = 1, inverse = 1;
};

/// The automatic exposure of shaders/exposure over the whole image, on the device: bit for bit what the graph of the
/// untiled frame computes. Overwrites `scratch`; if that does not hold the image, 16 bytes a pixel and some more, or
/// the device cannot bind so many pixels, the host computes it in double precision. Throws Error if the device fails.
FrameExposure exposureOf(Gpu& gpu, const PixelView& colour, Buffer& scratch);

/// The same in double precision on the host: equal to it within rounding.
FrameExposure exposureOnHost(const PixelView& colour);

}  // namespace xrds
