#pragma once

#include "frames/tile_runner.h"
#include "frames/window_mask.h"

namespace xrds {

/// What of a frame need not be computed.
struct SparseOptions {
  /// Windows may be interpolated if that changes them by at most this much: root mean square of log(1 + e radiance),
  /// with the exposure e. 0: none is. See bench/skip.md for how it was measured.
  float bound = 0;
  /// Windows keep their result of the run before if no input changed in them and `reach` low-resolution pixels around.
  /// An exposure that is not given then stays that of the first frame, until its own differs by more than 2 %.
  bool keepUnchanged = false;
  uint32_t reach = 0;  // whole windows
  uint32_t halo = 0;   // low-resolution pixels, whole windows, around what is computed
};

/// A model made ready to run on the parts of frames that need it: what is quiet is interpolated (QuietWindows), what
/// did not change since the frame before is kept, and the rest covered by few tiles. If all is needed the result is
/// that of the frame's own tiles bit for bit.
class SparseRunner {
 public:
  /// `grid`: the tiles of a whole frame as memory allows, or one tile. The device must outlive the runner. Throws Error
  /// if windows of this model's frames may not be interpolated but a bound is set.
  SparseRunner(Gpu& gpu, const NetworkModel& model, const SessionOptions& session, std::vector<Tile> grid,
               const SparseOptions& options);

  /// As TileRunner::run, for all of the output.
  bool run(const FrameInput& frame, std::span<float> output, const std::function<bool(double)>& progress = {});

  /// The windows of the last run that were interpolated, and those that were kept.
  const WindowMask& interpolated() const { return interpolated_; }
  const WindowMask& kept() const { return kept_; }
  /// Pixels of the crops in the last run over those of the frame.
  double work() const { return work_; }
  float exposure() const { return exposure_; }
  /// As Session::lostPixels(), those of kept windows included.
  const std::vector<uint64_t>& lostPixels() const { return lostPixels_; }
  const TileRunner& runner() const { return runner_; }

 private:
  /// The frame before, and its result.
  struct Last {
    std::vector<std::vector<float>> inputs;  // colour, then the auxiliary images, three floats a pixel
    std::vector<float> output;
    std::vector<uint64_t> lostPixels;
    float exposure = 0;
  };
  WindowMask changedWindows(const FrameInput& frame) const;
  std::vector<Tile> tilesOf(const WindowMask& needed);
  void copyKept(std::span<float> output);
  void remember(const FrameInput& frame, std::span<const float> output);

  NetworkConfig config_;
  TileRunner runner_;
  std::vector<Tile> grid_;
  SparseOptions options_;
  FrameShape frame_;
  WindowMask interpolated_, kept_;
  std::optional<Last> last_;
  std::vector<uint64_t> lostPixels_;
  double work_ = 1;
  float exposure_ = 1;
};

}  // namespace xrds
