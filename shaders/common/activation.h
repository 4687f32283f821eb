// The activations of the network, fused into the epilogue of linear and conv3x3.
#ifndef XRDS_SHADERS_COMMON_ACTIVATION_H
#define XRDS_SHADERS_COMMON_ACTIVATION_H
#include "shaders/common/shared.h"

XRDS_SHARED_BEGIN
const uint kActivationNone = 0;
const uint kActivationRelu = 1;
const uint kActivationLeakyRelu = 2;  // slope 0.01
const uint kActivationGelu = 3;       // x (1 + erf(x / sqrt 2)) / 2
XRDS_SHARED_END

#ifdef __cplusplus
#include <cmath>
namespace xrds {
enum class Activation : uint32_t { none, relu, leakyRelu, gelu };

/// Double precision, for reference().
inline double activate(Activation activation, double x) {
  switch (activation) {
    case Activation::relu:
      return x > 0 ? x : 0;
    case Activation::leakyRelu:
      return x > 0 ? x : 0.01 * x;
    case Activation::gelu:
      return x * (1 + std::erf(x / std::sqrt(2.0))) / 2;
    default:
      return x;
  }
}
}  // namespace xrds
#endif
#endif
