#pragma once

#include <cstdint>

#include "xrds/precision.h"

namespace xrds {

/// Storage of the activations and the packed weights; arithmetic is fp32 in either case.
enum class Precision : uint8_t { fp32, fp16 };

/// "fp32" or "fp16".
constexpr const char* nameOf(Precision precision) { return precisionName(precision == Precision::fp16); }

}  // namespace xrds
