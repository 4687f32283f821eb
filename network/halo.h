#pragma once

#include "network/config.h"

namespace xrds {

/// How far the network sees, in low-resolution pixels rounded up to whole windows. A crop that begins and ends at
/// multiples of the window, or at the frame's border, gives the frame's result bit for bit where it has that many
/// pixels around it. Throws Error if the network cannot be built.
uint32_t exactHalo(const NetworkConfig& config);

/// Whether every output pixel depends on the whole frame, as in RCAN, whose gates are of global means: no crop gives
/// the frame's result, and exactHalo() is longer than any frame.
bool seesWholeFrame(const NetworkConfig& config);

/// The halo of bounded tiles, two windows, at least 16 pixels, and at most exactHalo(): `xrds bench tiles` measures the
/// error that it leaves.
uint32_t boundedHalo(const NetworkConfig& config);

}  // namespace xrds
