#include "image/metrics/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "image/metrics/flip_filters.h"
#include "image/metrics/image_pair.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using Triple = std::array<double, 3>;
using Planes = std::array<Image, 3>;

// Linear sRGB to CIE XYZ under D65; its rows sum to the white point.
constexpr std::array<Triple, 3> kXyzFromRgb = {{{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                                {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                                {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}}};

double dot(const Triple& a, const Triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// XYZ over that of white.
Triple whiteRelative(const Triple& rgb) {
  constexpr Triple kWhite = {1.0, 1.0, 1.0};
  return {dot(kXyzFromRgb[0], rgb) / dot(kXyzFromRgb[0], kWhite),
          dot(kXyzFromRgb[1], rgb) / dot(kXyzFromRgb[1], kWhite),
          dot(kXyzFromRgb[2], rgb) / dot(kXyzFromRgb[2], kWhite)};
}

// The opponent space of section 4.1.1, linear in radiance: brightness, red against green, yellow against blue.
Triple opponentOf(const Triple& rgb) {
  const Triple t = whiteRelative(rgb);
  return {116.0 * t[1] - 16.0, 500.0 * (t[0] - t[1]), 200.0 * (t[1] - t[2])};
}

Triple whiteRelativeOfOpponent(const Triple& opponent) {
  const double y = (opponent[0] + 16.0) / 116.0;
  return {y + opponent[1] / 500.0, y, y - opponent[2] / 200.0};
}

// Cramer's rule on the matrix above.
Triple rgbOfWhiteRelative(const Triple& relative) {
  constexpr Triple kWhite = {1.0, 1.0, 1.0};
  const auto& m = kXyzFromRgb;
  const auto determinant = [](const Triple& a, const Triple& b, const Triple& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  };
  const double whole = determinant(m[0], m[1], m[2]);
  Triple rgb{};
  for (size_t column = 0; column < 3; ++column) {
    auto replaced = m;
    for (size_t row = 0; row < 3; ++row) {
      replaced[row][column] = relative[row] * dot(m[row], kWhite);
    }
    rgb[column] = determinant(replaced[0], replaced[1], replaced[2]) / whole;
  }
  return rgb;
}

// CIELAB with the Hunt effect: colours count less in the dark (section 4.1.3).
Triple huntAdjustedLab(const Triple& rgb) {
  constexpr double kDelta = 6.0 / 29.0;
  Triple f = whiteRelative(rgb);
  for (double& value : f) {
    value = value > kDelta * kDelta * kDelta ? std::cbrt(value) : value / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
  }
  const double lightness = 116.0 * f[1] - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (f[0] - f[1]), 0.01 * lightness * 200.0 * (f[1] - f[2])};
}

double hyab(const Triple& a, const Triple& b) { return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]); }

Planes opponentPlanes(const Image& image) {
  Planes planes = {Image(image.width, image.height, 1), Image(image.width, image.height, 1),
                   Image(image.width, image.height, 1)};
  for (size_t pixel = 0; pixel < image.pixelCount(); ++pixel) {
    Triple rgb{};
    for (size_t c = 0; c < 3; ++c) {
      rgb[c] = std::clamp(double{image.pixels[pixel * 3 + c]}, 0.0, 1.0);
    }
    const Triple opponent = opponentOf(rgb);
    for (size_t c = 0; c < 3; ++c) {
      planes[c].pixels[pixel] = static_cast<float>(opponent[c]);
    }
  }
  return planes;
}

// A term a sqrt(pi / b) exp(-pi^2 x^2 / b) of the eye's point spread function, x in degrees (section 4.1.1, table 1).
struct Spread {
  double a;
  double b;
};

constexpr Spread kBrightness = {1.0, 0.0047};
constexpr Spread kRedGreen = {1.0, 0.0053};
constexpr std::array<Spread, 2> kBlueYellow = {{{34.1, 0.04}, {13.5, 0.025}}};
constexpr double kWidestSpread = 0.04;

/// What the eye does to the three planes at one viewing distance.
class Eye {
 public:
  explicit Eye(double pixelsPerDegree)
      : pixelsPerDegree_(pixelsPerDegree), radius_(static_cast<int>(std::ceil(3.0 * deviation(kWidestSpread)))) {}

  Planes blurred(const Planes& planes) const {
    return {filtered(planes[0], filterOf(kBrightness)), filtered(planes[1], filterOf(kRedGreen)),
            blurredBlueYellow(planes[2])};
  }

 private:
  double deviation(double b) const {
    return std::sqrt(b / (2.0 * std::numbers::pi * std::numbers::pi)) * pixelsPerDegree_;
  }

  SeparableFilter filterOf(const Spread& spread) const {
    const std::vector<double> kernel = gaussian(deviation(spread.b), radius_);
    return {kernel, kernel};
  }

  // The sum of a spread's term over the pixels of the filter, before it is scaled to 1.
  double weightOf(const Spread& spread) const {
    double sum = 0.0;
    for (int x = -radius_; x <= radius_; ++x) {
      const double t = x / deviation(spread.b);
      sum += std::exp(-0.5 * t * t);
    }
    return spread.a * std::sqrt(std::numbers::pi / spread.b) * sum * sum;
  }

  // Two Gaussians, each separable though their sum is not.
  Image blurredBlueYellow(const Image& plane) const {
    Image first = filtered(plane, filterOf(kBlueYellow[0]));
    const Image second = filtered(plane, filterOf(kBlueYellow[1]));
    const double share = weightOf(kBlueYellow[0]) / (weightOf(kBlueYellow[0]) + weightOf(kBlueYellow[1]));
    std::transform(first.pixels.begin(), first.pixels.end(), second.pixels.begin(), first.pixels.begin(),
                   [share](float a, float b) { return static_cast<float>(share * a + (1.0 - share) * b); });
    return first;
  }

  double pixelsPerDegree_;
  int radius_;
};

Triple perceived(const Planes& planes, size_t pixel) {
  const Triple opponent = {planes[0].pixels[pixel], planes[1].pixels[pixel], planes[2].pixels[pixel]};
  Triple rgb = rgbOfWhiteRelative(whiteRelativeOfOpponent(opponent));
  for (double& value : rgb) {
    value = std::clamp(value, 0.0, 1.0);
  }
  return huntAdjustedLab(rgb);
}

// Colour difference in [0, 1]: large ones are compressed (section 4.1.4).
double colorError(const Triple& a, const Triple& b) {
  constexpr double kExponent = 0.7;
  constexpr double kKneeShare = 0.4;
  constexpr double kKneeValue = 0.95;
  static const double kLargest = std::pow(hyab(huntAdjustedLab({0, 1, 0}), huntAdjustedLab({0, 0, 1})), kExponent);
  const double error = std::pow(hyab(a, b), kExponent);
  const double knee = kKneeShare * kLargest;
  return error < knee ? kKneeValue / knee * error
                      : kKneeValue + (error - knee) / (kLargest - knee) * (1.0 - kKneeValue);
}

// The lengths of the filter's answers along both axes.
Image featureStrength(const Image& brightness, const std::vector<double>& derivative, const std::vector<double>& blur) {
  Image strength = filtered(brightness, {derivative, blur});
  const Image alongY = filtered(brightness, {blur, derivative});
  std::transform(strength.pixels.begin(), strength.pixels.end(), alongY.pixels.begin(), strength.pixels.begin(),
                 [](float x, float y) { return std::hypot(x, y); });
  return strength;
}

// Difference of edges and of points, whichever is larger, in [0, 1] (section 4.2).
Image featureErrors(const Image& result, const Image& reference, double pixelsPerDegree) {
  constexpr double kFeatureWidthDegrees = 0.082;
  const double deviation = 0.5 * kFeatureWidthDegrees * pixelsPerDegree;
  const int radius = static_cast<int>(std::ceil(3.0 * deviation));
  const std::vector<double> blur = gaussian(deviation, radius);
  Image errors(result.width, result.height, 1);
  for (const auto& derivative : {gaussianSlope(deviation, radius), gaussianCurvature(deviation, radius)}) {
    const Image ofResult = featureStrength(result, derivative, blur);
    const Image ofReference = featureStrength(reference, derivative, blur);
    for (size_t pixel = 0; pixel < errors.pixels.size(); ++pixel) {
      errors.pixels[pixel] =
          std::max(errors.pixels[pixel], std::abs(ofResult.pixels[pixel] - ofReference.pixels[pixel]));
    }
  }
  for (float& error : errors.pixels) {
    error = std::min(static_cast<float>(std::sqrt(error / std::numbers::sqrt2)), 1.0F);
  }
  return errors;
}

// The brightness plane as a number in [0, 1].
Image achromatic(const Planes& planes) {
  Image image = planes[0];
  for (float& value : image.pixels) {
    value = (value + 16.0F) / 116.0F;
  }
  return image;
}

}  // namespace

Image flipMap(const Image& result, const Image& reference, double pixelsPerDegree) {
  requireComparable(result, reference);
  if (result.channels != 3 || !(pixelsPerDegree > 0.0)) {
    throw Error("FLIP compares images of three channels at a positive number of pixels a degree: found " +
                std::to_string(result.channels) + " channels and " + std::to_string(pixelsPerDegree) + ".");
  }
  const Planes resultPlanes = opponentPlanes(result);
  const Planes referencePlanes = opponentPlanes(reference);
  Image map = featureErrors(achromatic(resultPlanes), achromatic(referencePlanes), pixelsPerDegree);
  const Eye eye(pixelsPerDegree);
  const Planes seenResult = eye.blurred(resultPlanes);
  const Planes seenReference = eye.blurred(referencePlanes);
  for (size_t pixel = 0; pixel < map.pixels.size(); ++pixel) {
    const double color = colorError(perceived(seenResult, pixel), perceived(seenReference, pixel));
    map.pixels[pixel] = static_cast<float>(std::pow(color, 1.0 - map.pixels[pixel]));
  }
  return map;
}

double flip(const Image& result, const Image& reference) {
  const Image map = flipMap(result, reference);
  return std::accumulate(map.pixels.begin(), map.pixels.end(), 0.0) / static_cast<double>(map.pixels.size());
}

}  // namespace xrds
