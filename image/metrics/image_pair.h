#pragma once

#include "image/image.h"

namespace xrds {

/// Throws Error unless both images have one size and number of channels, hold at least one pixel and finite values
/// only: what every metric asks of its result and reference.
void requireComparable(const Image& result, const Image& reference);

}  // namespace xrds
