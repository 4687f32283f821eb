#pragma once

#include <optional>

#include "checks/stress/frames.h"
#include "frames/sparse_runner.h"

namespace xrds {

/// Ways to upscale a frame in parts: what `xrds upscale` does with --tiles exact, --tiles bounded and --skip safe.
enum class Parts { exactTiles, boundedTiles, skip };
inline constexpr Parts kAllParts[] = {Parts::exactTiles, Parts::boundedTiles, Parts::skip};

/// The smallest frame that exact tiles of the model, or bounded ones where seesWholeFrame(), cut in two: two windows of
/// rows, the last of which is cut.
FrameShape partedFrame(const NetworkConfig& config);

/// A model made ready for frames of that shape, in parts.
class PartRunner {
 public:
  /// The device and the model must outlive the runner. Throws Error if the device fails, or if windows of this model's
  /// frames may not be skipped (whyNeverQuiet()).
  PartRunner(Gpu& gpu, const NetworkModel& model, Precision precision, Parts parts);

  /// Upscales a frame into output [s h, s w, 3].
  void run(const StressFrame& frame, bool autoExposure, std::span<float> output);

  Parts parts() const { return parts_; }
  uint64_t lostPixels() const { return sparse_ ? sparse_->lostPixels().size() : tiled_->lostPixels().size(); }
  /// The largest change of a window that the last run interpolated: root mean square of log(1 + e radiance) against
  /// `whole` [s h, s w, 3], with the exposure e.
  double largestSkippedChange(std::span<const float> output, std::span<const float> whole) const;

 private:
  const Parts parts_;
  const NetworkConfig config_;
  const FrameShape shape_;
  std::vector<Tile> tiles_;
  std::optional<TileRunner> tiled_;
  std::optional<SparseRunner> sparse_;
};

}  // namespace xrds
