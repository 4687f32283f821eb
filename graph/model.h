#pragma once

#include <deque>
#include <filesystem>
#include <memory>

#include "graph/network.h"
#include "graph/safetensors.h"

namespace xrds {

/// A network's symbols and weights, checked to be complete.
class ModelWeights {
 public:
  /// Throws Error if the file is no model of ours, misses a tensor, or holds one that does not belong to the network,
  /// has another shape, or is not finite.
  static ModelWeights read(const std::filesystem::path& path);
  static ModelWeights fromTensors(TensorFile file, const std::string& name);
  /// Deterministic random weights, variance-preserving: for benchmarks and tests without a file.
  static ModelWeights random(const NetworkConfig& config, uint32_t seed);

  const NetworkConfig& config() const { return config_; }
  const TensorFile& file() const { return *file_; }
  uint64_t parameterCount() const;
  /// Valid as long as this object or a copy of it lives.
  WeightLookup lookup() const;

 private:
  NetworkConfig config_;
  std::shared_ptr<const TensorFile> file_;
};

}  // namespace xrds
