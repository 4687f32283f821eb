#pragma once

#include <vector>

#include "image/image.h"

namespace xrds {

/// A filter that runs along rows and then along columns; both kernels have an odd length and their middle is the
/// origin.
struct SeparableFilter {
  std::vector<double> alongX;
  std::vector<double> alongY;
};

/// The filtered image, one channel, borders replicated.
Image filtered(const Image& image, const SeparableFilter& filter);

/// A Gaussian exp(-x^2 / (2 deviation^2)) at whole x from -radius to radius, with unit sum.
std::vector<double> gaussian(double deviation, int radius);

/// x times that Gaussian, negated, scaled so that its positive values sum to 1: the first derivative that finds edges.
std::vector<double> gaussianSlope(double deviation, int radius);

/// (x^2 / deviation^2 - 1) times that Gaussian, its positive values scaled to sum 1 and its negative ones to -1: the
/// second derivative that finds points.
std::vector<double> gaussianCurvature(double deviation, int radius);

}  // namespace xrds
