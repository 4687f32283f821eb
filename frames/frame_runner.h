#pragma once

#include <functional>
#include <memory>

#include "frames/host_frame.h"
#include "frames/sparse_runner.h"

namespace xrds {

struct DenoisingParts;

/// A model made ready to run on frames of one shape: as a whole, in tiles, or in the parts that need it.
class FrameRunner {
 public:
  virtual ~FrameRunner() = default;

  /// Upscales a frame into output [s h, s w, 3]. `progress` gets the finished share in [0, 1] and stops the run by
  /// returning false; then false is returned. Throws Error if the device fails.
  virtual bool run(const FrameInput& frame, std::span<float> output, const std::function<bool(double)>& progress) = 0;

  /// Of the last run: its exposure, the pixels of the output without the network's share, which was not finite there,
  /// and the time of each dispatch (needs timestamps).
  virtual float exposure() const = 0;
  virtual const std::vector<uint64_t>& lostPixels() const = 0;
  virtual std::vector<DispatchTime> times() const = 0;
  /// Device memory in use.
  virtual uint64_t byteSize() const = 0;

  /// What a frame is made of, for programs that run it on the device themselves; empty: which parts it has depends on
  /// its pixels.
  virtual std::vector<FramePart> parts() { return {}; }
  /// What stands in front of the parts; null: nothing does.
  virtual const DenoisingParts* denoising() const { return nullptr; }
  /// What skips windows; null: nothing does.
  virtual const SparseRunner* sparse() const { return nullptr; }
};

/// The frame as a whole, in bands as narrow as they can be where the device has no room for it (openSession).
std::unique_ptr<FrameRunner> wholeRunner(Gpu& gpu, const NetworkModel& model, FrameShape frame,
                                         const SessionOptions& options);
/// In tiles, as TileRunner does.
std::unique_ptr<FrameRunner> tiledRunner(Gpu& gpu, const NetworkModel& model, std::vector<Tile> tiles,
                                         const SessionOptions& options);
/// Where it is needed, as SparseRunner does.
std::unique_ptr<FrameRunner> partsRunner(Gpu& gpu, const NetworkModel& model, std::vector<Tile> tiles,
                                         const SessionOptions& options, const SparseOptions& sparse);

/// `progress` as sessions call it, with the submissions done and their total.
std::function<bool(size_t, size_t)> countingShare(const std::function<bool(double)>& progress);

}  // namespace xrds
