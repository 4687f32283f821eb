#pragma once

#include <cstdint>

namespace xrds {

/// Storage of the activations and the packed weights; arithmetic is fp32 in either case.
enum class Precision : uint8_t { fp32, fp16 };

}  // namespace xrds
