#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/tensor.h"
#include "network/config.h"

namespace xrds {

/// One tensor of a weight file, widened to 32-bit float.
struct StoredTensor {
  std::vector<uint64_t> shape;
  std::vector<float> values;  // row-major
};

/// The content of a safetensors file: named tensors and string metadata.
struct TensorFile {
  std::map<std::string, StoredTensor> tensors;
  Metadata metadata;
  uint64_t hash = 0;  // FNV-1a of the file's bytes
};

/// Parses a safetensors file held in memory; element types F32, F16 and BF16. Throws Error, prefixed with `name`, if
/// it is truncated, inconsistent, or of another type: nothing in the file is trusted.
TensorFile parseTensors(std::span<const std::byte> bytes, const std::string& name);

/// Reads a file of at most 1 GiB. Throws Error.
TensorFile readTensors(const std::filesystem::path& path);

/// Writes through a temporary file that is renamed. Throws Error.
void writeTensors(const std::filesystem::path& path, const TensorFile& file, DataType type);

}  // namespace xrds
