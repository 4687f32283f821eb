#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "xrds/xrds.hpp"

namespace xrds {

/// Networks that stay prepared on a device between the frames of a sequence, in at most a quarter of its memory. Those
/// that were not taken for a while, as after a change of size, go. They must go before the device and the models do.
class PreparedNetworks {
 public:
  /// One of the model for frames of that size that was put here; null if there is none.
  std::unique_ptr<Upscaler> take(const Model& model, uint32_t width, uint32_t height);

  /// Keeps it where the memory allows it.
  void put(const Device& device, const Model& model, uint32_t width, uint32_t height,
           std::unique_ptr<Upscaler> network);

  void clear() { kept_.clear(); }

 private:
  struct Kept {
    const Model* model;
    uint32_t width, height;
    uint64_t putAt;
    std::unique_ptr<Upscaler> network;
  };

  std::vector<Kept> kept_;
  uint64_t puts_ = 0;
};

}  // namespace xrds
