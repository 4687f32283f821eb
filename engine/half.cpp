#include "engine/half.h"

#include <bit>
#include <cmath>

namespace xrds {

uint16_t toHalf(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  const auto sign = static_cast<uint16_t>(bits >> 16 & 0x8000u);
  const float magnitude = std::fabs(value);
  if (std::isnan(value)) return sign | 0x7E00u;
  if (magnitude >= 65520.0f) return sign | 0x7C00u;  // 65504 is the largest; halfway above it rounds to infinity
  // Below 2^-14 the steps are 2^-24 wide: adding 0.5 puts the value where a float's last bit is that step.
  if (magnitude < 0x1p-14f) return sign | static_cast<uint16_t>(std::bit_cast<uint32_t>(magnitude + 0.5f) & 0x7FFu);
  const uint32_t rounded = (bits & 0x7FFFFFFFu) + 0xFFFu + (bits >> 13 & 1u);
  return sign | static_cast<uint16_t>((rounded - (112u << 23)) >> 13);
}

float fromHalf(uint16_t half) {
  const uint32_t exponent = half >> 10 & 0x1Fu, fraction = half & 0x3FFu;
  const float sign = (half & 0x8000u) ? -1.0f : 1.0f;
  if (exponent == 0) return sign * static_cast<float>(fraction) * 0x1p-24f;
  if (exponent == 31) return fraction ? std::nanf("") : sign * INFINITY;
  return sign * std::bit_cast<float>((exponent + 112u) << 23 | fraction << 13);
}

}  // namespace xrds
