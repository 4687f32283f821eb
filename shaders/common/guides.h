// How alike two pixels are by their albedo and normal.
#ifndef XRDS_SHADERS_COMMON_GUIDES_H
#define XRDS_SHADERS_COMMON_GUIDES_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
const float kSigmaNormal = 0.2f;
const float kSigmaAlbedo = 0.5f;
const float kBilateralFloor = 1e-6f;  // keeps the weights of pixels that resemble no neighbour
XRDS_SHARED_END

#ifdef __cplusplus
#include <cmath>

namespace xrds {

/// exp(-|n - m|^2 / (2 0.2^2) - |a - b|^2 / (2 0.5^2)) of two pixels' albedo and normal in double precision, given as
/// functions of the channel; a normalOffset of -1 leaves the normals out.
double likeness(int albedoOffset, int normalOffset, const auto& first, const auto& second) {
  const auto square = [&](int offset, double sigma) {
    double sum = 0;
    for (int c = offset; offset >= 0 && c < offset + 3; ++c) {
      const double difference = first(static_cast<uint32_t>(c)) - second(static_cast<uint32_t>(c));
      sum += difference * difference;
    }
    return sum / (2 * sigma * sigma);
  };
  return std::exp(-square(normalOffset, 0.2) - square(albedoOffset, 0.5));
}

}  // namespace xrds
#endif
#endif
