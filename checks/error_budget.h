#pragma once

#include "network/precision.h"
#include "shaders/common/operator_facts.h"

namespace xrds {

/// The budget of values that are stored in that precision.
constexpr double boundOf(const ErrorBudget& budget, Precision precision) {
  return precision == Precision::fp32 ? budget.fp32 : budget.fp16;
}

/// Of the image, in the transformed domain.
inline constexpr ErrorBudget kNetworkBudget{1e-4, 5e-3};
/// Of a value inside the network, after all operators before it.
inline constexpr ErrorBudget kChainBudget{1e-4, 2e-2};

}  // namespace xrds
