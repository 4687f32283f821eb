#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "network/safetensors.h"

namespace xrds {

/// Whether the bytes begin as a TZA archive does.
bool isTza(std::span<const std::byte> bytes);

/// Parses a TZA archive, the weights of Open Image Denoise: little-endian, a head of magic number, version 2 and the
/// offset of a table; of each tensor its name, shape, layout (x or oihw), type (half or float) and offset. Bytes behind
/// the archive are ignored. Throws Error, prefixed with `name`, if it is truncated, inconsistent or of another type:
/// nothing in it is trusted.
TensorFile parseTza(std::span<const std::byte> bytes, const std::string& name);

}  // namespace xrds
