#pragma once

#include <map>
#include <memory>

#include "frames/frame_exposure.h"
#include "frames/session.h"
#include "frames/tiles.h"

namespace xrds {

/// A model made ready to run on tiles of frames: one session for each size of crop, all in the arena of the largest,
/// planned and recorded once and kept from run to run.
class TileRunner {
 public:
  /// The device must outlive the runner. `options` are those of the sessions; the exposure is always given to them.
  TileRunner(Gpu& gpu, NetworkModel model, const SessionOptions& options);

  /// Makes the sessions of these tiles, which run() else does. Throws Error if the device cannot hold them.
  void prepare(std::span<const Tile> tiles);

  /// Upscales the tiles and writes their inner parts to output [s h, s w, 3]; the rest of it stays as it is. A crop
  /// that leaves the frame to the left or right reads its other side. `progress` gets the finished share in [0, 1],
  /// also within a tile, and stops the run by returning false; then false is returned and some tiles are written.
  /// Throws Error if the device fails.
  bool run(const FrameInput& frame, std::span<const Tile> tiles, std::span<float> output,
           const std::function<bool(double)>& progress = {});

  /// The session of a prepared tile's crop.
  Session& sessionOf(const Rectangle& crop);

  /// Device memory in use: the arena and the weights, once each.
  uint64_t byteSize() const;
  /// The exposure of the last run.
  float exposure() const { return exposure_.value; }
  /// As Session::lostPixels(), of the whole output: those that the last run wrote.
  const std::vector<uint64_t>& lostPixels() const { return lostPixels_; }
  /// Time of each operator in the last run, over all tiles; needs timestamps.
  const std::vector<DispatchTime>& times() const { return times_; }

 private:
  using Size = std::pair<uint32_t, uint32_t>;  // height and width of a crop
  void store(const Session& session, const Tile& tile, const FrameInput& frame, std::span<float> output);
  void addTimes(const Session& session);

  Gpu& gpu_;
  NetworkModel model_;
  SessionOptions options_;
  std::unique_ptr<Session> largest_;  // whose memory the others use, so they go first
  Size largestSize_{};
  std::map<Size, std::unique_ptr<Session>> others_;
  FrameExposure exposure_;
  std::vector<uint64_t> lostPixels_;
  std::vector<DispatchTime> times_;
};

}  // namespace xrds
