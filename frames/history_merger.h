#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "frames/device_images.h"

namespace xrds {

/// A frame of a sequence as the device takes it, row by row: functions that write row y of pixels, from several threads
/// at once, as shaders/common/history.h has them, and of where each went.
struct HistoryFrame {
  using WriteRow = std::function<void(uint32_t y, std::span<float> row)>;
  WriteRow low, full;               // [w, 12] with the radiance and count alone; [s w, 12]
  WriteRow toPrevious{}, toNext{};  // [s w, 4] motion to the frame before and after; empty: not known
  bool hasFullColour = true;        // else the radiance of the full resolution is 0, of all frames
};

/// Merges frames of one size with those around them (docs/temporal.md): the operators follow_motion, warp_history,
/// merge_history and resolve_history on the low- and on the full-resolution images. What is warped is there in bands
/// of rows alone; sums and positions move by a band at each step, up and down in turn, so that none is there twice.
class HistoryMerger {
 public:
  /// height x width: of the low-resolution images. bandRows: of a band at each resolution, 0: those that suit the
  /// height; the results are the same bits. Throws OutOfMemory if the device has no room.
  HistoryMerger(Gpu& gpu, uint32_t height, uint32_t width, uint32_t scale, uint32_t bandRows = 0);

  /// Takes row y of a result; several threads at once, each for other rows.
  using TakeRow = std::function<void(uint32_t y, std::span<const float> row)>;

  /// The frame merged with those `before`, the nearest first, as far as there is motion to follow, then with those
  /// `after`. Gives rows of low [w, 4] and full [s w, 12]; both are the frame's own pixels where nothing is merged.
  void run(const HistoryFrame& present, std::span<const HistoryFrame> before, std::span<const HistoryFrame> after,
           const TakeRow& low, const TakeRow& full);

  uint64_t deviceBytes() const { return images_.byteSize(); }

 private:
  using Motion = HistoryFrame::WriteRow HistoryFrame::*;

  /// An image that each step reads from one place and writes, band by band, to the other, a band of rows above or
  /// below it.
  struct Moving {
    TensorView above, below;
    const TensorView& at(uint32_t step) const { return step % 2 == 0 ? above : below; }
  };
  /// The images of one resolution.
  struct Level {
    uint32_t height = 0, bandRows = 0, scale = 1;  // scale: of the positions over its pixels
    TensorView present, history, warped;           // warped: rows of a band and around it
    uint32_t radius = 2;                           // of merge_history
    Moving sums;
    std::vector<RowRange> bands() const;
    TensorView warpedRows(uint32_t first) const;
  };

  Moving createMoving(const char* name, TensorShape shape, uint32_t bandRows);
  Level createLevel(uint32_t scale, uint32_t bandRows);
  TensorView inPlaceOf(const TensorView& view, uint32_t channels) const;
  void addMerging(const Level& level, const TensorView& positions, uint32_t merged, std::vector<Operator>& to) const;
  Recording record(std::vector<Operator> operators);
  void giveOwn(const HistoryFrame& present, const TakeRow& low, const TakeRow& full) const;
  void mergeChain(const HistoryFrame& present, std::span<const HistoryFrame> chain, Motion motion);
  Recording& follow(uint32_t inChain);
  Recording& merge(uint32_t inChain);
  void finish();

  Gpu& gpu_;
  uint32_t height_, width_, scale_;
  DeviceImages images_;
  Level low_, full_;
  Moving positions_;
  TensorView motion_, exposure_, lowPositions_, lowGuides_, resultLow_, resultFull_;
  std::optional<Recording> prepare_;
  std::map<uint32_t, Recording> follow_;  // by the step in a chain, 0 or as 1 and 2
  std::map<std::tuple<uint32_t, bool, uint32_t, uint32_t>, Recording> merging_;  // by places of positions and sums
  std::optional<Recording> finish_[2];
  uint32_t merged_ = 0;  // frames so far
};

}  // namespace xrds
