#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "engine/recording.h"
#include "graph/graph.h"

namespace xrds {

/// Images on a device beside those of sessions, each f32 in a buffer of its own, and operators on them.
class DeviceImages {
 public:
  explicit DeviceImages(Gpu& gpu) : gpu_(gpu) {}

  /// Throws OutOfMemory if the device has no room for it.
  TensorView create(const char* name, TensorShape shape);
  Buffer& bufferOf(const TensorView& image) const { return *buffers_[image.value]; }

  /// The dispatches of operators on these images, in their order.
  std::vector<PlacedDispatch> placed(std::vector<Operator> operators) const;

  /// Row by row, several threads at once, as Buffer::uploadRows() has it; blocks.
  void upload(const TensorView& image, const std::function<void(uint32_t y, std::span<float> row)>& write);
  void download(const TensorView& image, const std::function<void(uint32_t y, std::span<const float> row)>& read) const;

  uint64_t byteSize() const;

 private:
  Gpu& gpu_;
  Graph graph_;  // values alone
  std::vector<std::unique_ptr<Buffer>> buffers_;
};

}  // namespace xrds
