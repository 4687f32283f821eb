#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>

#include "network/network.h"
#include "network/safetensors.h"

namespace xrds {

/// A network's symbols and weights, checked to be complete.
class NetworkModel {
 public:
  /// Throws Error if the file is no model of ours, misses a tensor, or holds one that does not belong to the network,
  /// has another shape, or is not finite.
  static NetworkModel read(const std::filesystem::path& path);
  static NetworkModel fromTensors(TensorFile file, const std::string& name);
  /// Deterministic random weights, variance-preserving: for benchmarks and tests without a file.
  static NetworkModel random(const NetworkConfig& config, uint32_t seed);

  const NetworkConfig& config() const { return config_; }
  /// The same network for colours that were denoised before; shares the weights.
  NetworkModel behindDenoiser() const;
  const TensorFile& file() const { return *file_; }
  uint64_t parameterCount() const;
  /// Valid as long as this object or a copy of it lives.
  WeightLookup lookup() const;

 private:
  NetworkConfig config_;
  std::shared_ptr<const TensorFile> file_;
};

/// Every tensor of the network, filled by `fill` in the order of the forward pass, and the metadata that describes it.
TensorFile makeTensors(const NetworkConfig& config,
                       const std::function<void(const std::string& name, StoredTensor& tensor)>& fill);

}  // namespace xrds
