// The radiance transform T between linear radiance and what the network sees.
#ifndef XRDS_SHADERS_COMMON_TRANSFER_H
#define XRDS_SHADERS_COMMON_TRANSFER_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
const uint kTransferNone = 0;
const uint kTransferLog1p = 1;       // log(1 + max(x, 0))
const float kAlbedoEpsilon = 0.02f;  // added to the albedo before dividing and multiplying by it
const float kAlbedoMax = 4.0f;
const float kAuxiliaryMax = 65504.0f;  // of other auxiliary channels: the same whether they are stored as half or float
const float kTransformedMax = 11.0f;   // of a sum of base image and residual, unless the base alone is larger
const float kLinearMax = 1e18f;        // of what the transfer `none` hands on: squares of it are still floats
const float kLogarithmsFrom = 1e30f;   // above this, products are taken as sums of logarithms
const float kRadianceMax = 3.4028234e38f;
XRDS_SHARED_END

#ifdef __cplusplus
#include <algorithm>
#include <cmath>
namespace xrds {
enum class Transfer : uint32_t { none, log1p };

/// T in double precision, for reference().
inline double transform(Transfer transfer, double x) {
  const double limit = shader::kLinearMax;
  return transfer == Transfer::log1p ? std::log1p(std::max(x, 0.0)) : std::clamp(x, -limit, limit);
}

/// T^-1 in double precision, for reference().
inline double inverseTransform(Transfer transfer, double x) { return transfer == Transfer::log1p ? std::expm1(x) : x; }
}  // namespace xrds
#endif
#endif
