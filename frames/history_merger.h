#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/recording.h"
#include "graph/graph.h"

namespace xrds {

/// A frame of a sequence as the device takes it: pixels as shaders/common/history.h has them, and where each went.
struct PackedFrame {
  std::vector<float> low, full;               // [h, w, 12] with the radiance and count alone; [s h, s w, 12]
  std::vector<float> toPrevious{}, toNext{};  // [s h, s w, 4] motion to the frame before and after; empty: not known
};

/// Merges frames of one size with those around them (docs/temporal.md): the operators follow_motion, warp_history,
/// merge_history and resolve_history on the low- and on the full-resolution images.
class HistoryMerger {
 public:
  /// height x width: of the low-resolution images. Throws OutOfMemory if the device has no room.
  HistoryMerger(Gpu& gpu, uint32_t height, uint32_t width, uint32_t scale);

  /// The frame merged with those `before`, the nearest first, as far as there is motion to follow, then with those
  /// `after`. Writes low [h, w, 4] and full [s h, s w, 12]; both keep the frame's own pixels where nothing is merged.
  void run(const PackedFrame& present, std::span<const PackedFrame* const> before,
           std::span<const PackedFrame* const> after, std::span<float> low, std::span<float> full);

  uint64_t deviceBytes() const;

 private:
  using Motion = std::vector<float> PackedFrame::*;
  TensorView create(const char* name, uint32_t scale, uint32_t channels);
  Recording record(std::vector<Operator> operators);
  void upload(const TensorView& view, std::span<const float> values);
  void download(const TensorView& view, std::span<float> values) const;
  void mergeChain(const PackedFrame& present, std::span<const PackedFrame* const> chain, Motion motion);
  void mergeStep(bool first);
  void finish();

  Gpu& gpu_;
  uint32_t height_, width_, scale_;
  Graph graph_;  // values alone
  std::vector<std::unique_ptr<Buffer>> buffers_;
  TensorView low_, full_, historyLow_, historyFull_, motion_, exposure_, lowPositions_, warpedLow_, warpedFull_,
      lowGuides_, resultLow_, resultFull_;
  TensorView positions_[2], sumsLow_[2], sumsFull_[2];
  std::optional<Recording> prepare_;
  std::map<std::pair<uint32_t, uint32_t>, Recording> steps_;  // by which positions and which sums they read
  std::optional<Recording> finish_[2];
  uint32_t inChain_ = 0, merged_ = 0;  // steps so far of a chain, and of the frame
};

}  // namespace xrds
