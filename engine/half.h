#pragma once

#include <cstdint>

namespace xrds {

/// The binary16 nearest to the value, ties to even; beyond its range infinity, NaN stays NaN.
uint16_t toHalf(float value);

float fromHalf(uint16_t half);

}  // namespace xrds
