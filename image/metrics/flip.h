#pragma once

#include "image/image.h"

namespace xrds {

/// The viewing condition of every FLIP number that this project reports: pixels that one degree of the field of view
/// covers (a 4K display of 0.7 m width seen from 0.7 m).
inline constexpr double kFlipPixelsPerDegree = 67.0;

/// The perceived difference of two images that are flipped between on a display, as a one-channel map of values in
/// [0, 1]. Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020 (LDR-FLIP); section
/// numbers in the source are of that paper. Input: linear radiance of three channels, clamped to [0, 1]. Throws Error
/// when the images differ in size, have other than three channels, are empty or hold values that are not finite.
Image flipMap(const Image& result, const Image& reference, double pixelsPerDegree = kFlipPixelsPerDegree);

/// The mean of the map, the number called FLIP in reports.
double flip(const Image& result, const Image& reference);

}  // namespace xrds
