#pragma once

#include <string>
#include <vector>

#include "image/image.h"

namespace xrds {

/// How far a result is from its reference, in numbers that mean the same everywhere in this project.
struct Metrics {
  double psnr = 0.0;           ///< Decibels; infinite for equal images.
  double relMse = 0.0;         ///< Mean over all pixels.
  double relMseTrimmed = 0.0;  ///< Mean without the worst 0.1 % of the pixels.
  double relMseMedian = 0.0;
  double relMsePercentile999 = 0.0;
  double flip = 0.0;  ///< 0 to 1.
};

inline constexpr const char* kPsnrDefinition =
    "PSNR: linear radiance clamped to [0, 1], sRGB transfer function, mean squared error over all pixels and channels, "
    "10 log10(1 / MSE), in dB";
inline constexpr const char* kRelMseDefinition =
    "RelMSE: a pixel's value is the mean over its channels of (x - y)^2 / (y^2 + 0.01), x result, y reference, linear "
    "radiance; the mean over all pixels, untrimmed";
inline constexpr const char* kRelMseTrimmedDefinition =
    "RelMSE trimmed: RelMSE without the worst 0.1 % of the pixels (their number rounded down)";
inline constexpr const char* kRelMseMedianDefinition =
    "RelMSE median: the middle of the pixels' values in order, the mean of the middle two for an even number";
inline constexpr const char* kRelMsePercentile999Definition =
    "RelMSE 99.9th percentile: the smallest pixel value that at least 99.9 % of the pixels do not exceed";
inline constexpr const char* kFlipDefinition =
    "FLIP: LDR-FLIP (Andersson et al. 2020), linear radiance clamped to [0, 1], 67 pixels a degree, mean over all "
    "pixels";

/// All metrics of a result against a reference of the same size, both linear radiance in the same exposure with three
/// channels. Throws Error when sizes or channels differ, an image is empty or a value is not finite.
Metrics measure(const Image& result, const Image& reference);

/// PSNR as kPsnrDefinition has it; any number of channels. Throws as `measure` does.
double psnr(const Image& result, const Image& reference);

/// The RelMSE value of every pixel as a one-channel image; any number of channels. Throws as `measure` does.
Image relMseMap(const Image& result, const Image& reference);

/// The definitions of all metrics, in the order of the fields of Metrics.
std::vector<std::string> metricDefinitions();

}  // namespace xrds
