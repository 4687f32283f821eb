// The radiance transform T between linear radiance and what the network sees.
#ifndef XRDS_SHADERS_COMMON_TRANSFER_H
#define XRDS_SHADERS_COMMON_TRANSFER_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
const uint kTransferNone = 0;
const uint kTransferLog1p = 1;       // log(1 + max(x, 0))
const float kAlbedoEpsilon = 0.02f;  // added to the albedo before dividing and multiplying by it
const float kAlbedoMax = 4.0f;
const float kTransformedMax = 11.0f;  // of a result that is added to a base image
XRDS_SHARED_END

#ifdef __cplusplus
#include <algorithm>
#include <cmath>
namespace xrds {
enum class Transfer : uint32_t { none, log1p };

/// T in double precision, for reference().
inline double transform(Transfer transfer, double x) {
  return transfer == Transfer::log1p ? std::log1p(std::max(x, 0.0)) : x;
}

/// T^-1 in double precision, for reference().
inline double inverseTransform(Transfer transfer, double x) { return transfer == Transfer::log1p ? std::expm1(x) : x; }
}  // namespace xrds
#endif
#endif
