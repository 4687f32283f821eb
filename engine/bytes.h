#pragma once

#include <span>
#include <vector>

#include "engine/tensor.h"

namespace xrds {

/// The numbers as a tensor of the type stores them: toHalf() of each, or their own bytes.
std::vector<std::byte> encode(std::span<const float> numbers, DataType type);

/// The numbers that a tensor of the type stores; the opposite of encode().
std::vector<float> decode(std::span<const std::byte> bytes, DataType type);

/// FNV-1a of the bytes, 64 bits; of bytes in several pieces, with the hash of those before as `begin`.
uint64_t hashOf(std::span<const std::byte> bytes, uint64_t begin = 0xcbf29ce484222325);

}  // namespace xrds
