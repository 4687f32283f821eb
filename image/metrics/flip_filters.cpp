#include "image/metrics/flip_filters.h"

#include <algorithm>
#include <cmath>

namespace xrds {
namespace {

std::vector<double> sampled(double deviation, int radius, double (*factor)(double)) {
  std::vector<double> kernel;
  for (int x = -radius; x <= radius; ++x) {
    const double t = x / deviation;
    kernel.push_back(factor(t) * std::exp(-0.5 * t * t));
  }
  return kernel;
}

// Scales positive and negative values apart, each to a sum of 1 or -1.
void balance(std::vector<double>& kernel) {
  double positive = 0.0;
  double negative = 0.0;
  for (const double value : kernel) {
    (value > 0.0 ? positive : negative) += std::abs(value);
  }
  for (double& value : kernel) {
    value /= value > 0.0 ? positive : std::max(negative, 1e-300);
  }
}

Image filteredAlongX(const Image& image, const std::vector<double>& kernel) {
  Image result(image.width, image.height, 1);
  const int radius = static_cast<int>(kernel.size()) / 2;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      double sum = 0.0;
      for (int k = -radius; k <= radius; ++k) {
        sum += kernel[size_t(k + radius)] * image.at(std::clamp(x + k, 0, image.width - 1), y, 0);
      }
      result.at(x, y, 0) = static_cast<float>(sum);
    }
  }
  return result;
}

Image filteredAlongY(const Image& image, const std::vector<double>& kernel) {
  Image result(image.width, image.height, 1);
  const int radius = static_cast<int>(kernel.size()) / 2;
  std::vector<double> sums(size_t(image.width));
  for (int y = 0; y < image.height; ++y) {
    std::fill(sums.begin(), sums.end(), 0.0);
    for (int k = -radius; k <= radius; ++k) {
      const float* row = &image.pixels[image.index(0, std::clamp(y + k, 0, image.height - 1))];
      for (size_t x = 0; x < sums.size(); ++x) {
        sums[x] += kernel[size_t(k + radius)] * row[x];
      }
    }
    std::transform(sums.begin(), sums.end(), &result.pixels[result.index(0, y)],
                   [](double sum) { return static_cast<float>(sum); });
  }
  return result;
}

}  // namespace

Image filtered(const Image& image, const SeparableFilter& filter) {
  return filteredAlongY(filteredAlongX(image, filter.alongX), filter.alongY);
}

std::vector<double> gaussian(double deviation, int radius) {
  std::vector<double> kernel = sampled(deviation, radius, [](double) { return 1.0; });
  balance(kernel);
  return kernel;
}

std::vector<double> gaussianSlope(double deviation, int radius) {
  std::vector<double> kernel = sampled(deviation, radius, [](double t) { return -t; });
  balance(kernel);
  return kernel;
}

std::vector<double> gaussianCurvature(double deviation, int radius) {
  std::vector<double> kernel = sampled(deviation, radius, [](double t) { return t * t - 1.0; });
  balance(kernel);
  return kernel;
}

}  // namespace xrds
