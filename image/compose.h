#pragma once

#include <vector>

#include "image/image.h"

namespace xrds {

/// The image with every pixel repeated `scale` times in both directions: shows what a low-resolution render has,
/// without any interpolation. `scale` must be at least 1, otherwise throws Error.
Image enlargeNearest(const Image& image, int scale);

/// The images from left to right with `gap` black columns between them. Throws Error unless there is at least one and
/// all have one height and number of channels, and `gap` is not negative.
Image sideBySide(const std::vector<Image>& images, int gap = 0);

/// A one-channel error map as three channels of linear light, from dark violet (0) over green to yellow (`maximum` and
/// above); NaN is shown in magenta. Written with exposure 1 its colours are even steps to the eye. Throws Error when
/// the map has more than one channel or `maximum` is not positive.
Image heatMap(const Image& error, float maximum);

}  // namespace xrds
