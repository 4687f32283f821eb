#pragma once

#include <vector>

#include "xrds/pixel_view.h"

namespace xrds {

/// estimatedFullShare(), colourDifference(), mergedColour() and levelledColour() of the public API, which documents
/// them, of images whose pixels are finite.
double shareByNoise(const PixelView& low, const PixelView& full);
double differenceOf(const PixelView& low, const PixelView& full);
std::vector<float> mergedByShare(const PixelView& low, const PixelView& full, double share);
std::vector<float> atLevelOf(const PixelView& full, const PixelView& merged);

}  // namespace xrds
