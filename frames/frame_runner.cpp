#include "frames/frame_runner.h"

namespace xrds {
namespace {

class WholeFrame : public FrameRunner {
 public:
  WholeFrame(Gpu& gpu, const NetworkModel& model, FrameShape frame, const SessionOptions& options) {
    openSession(session_, gpu, model, frame, options);
  }
  bool run(const FrameInput& frame, std::span<float> output, const std::function<bool(double)>& progress) override {
    return session_->run(frame, output, countingShare(progress));
  }
  float exposure() const override { return session_->exposure(); }
  const std::vector<uint64_t>& lostPixels() const override { return session_->lostPixels(); }
  std::vector<DispatchTime> times() const override { return session_->times(); }
  uint64_t byteSize() const override { return session_->ownByteSize(); }
  std::vector<FramePart> parts() override {
    const TensorView& colour = session_->graph().colour;
    const Rectangle frame{0, 0, colour.width, colour.height};
    return {{&*session_, {frame, frame}}};
  }

 private:
  std::optional<Session> session_;
};

class TiledFrame : public FrameRunner {
 public:
  TiledFrame(Gpu& gpu, const NetworkModel& model, std::vector<Tile> tiles, const SessionOptions& options)
      : tiles_(std::move(tiles)), runner_(gpu, model, options) {
    runner_.prepare(tiles_);
  }
  bool run(const FrameInput& frame, std::span<float> output, const std::function<bool(double)>& progress) override {
    return runner_.run(frame, tiles_, output, progress);
  }
  float exposure() const override { return runner_.exposure(); }
  const std::vector<uint64_t>& lostPixels() const override { return runner_.lostPixels(); }
  std::vector<DispatchTime> times() const override { return runner_.times(); }
  uint64_t byteSize() const override { return runner_.byteSize(); }
  std::vector<FramePart> parts() override {
    std::vector<FramePart> parts;
    for (const Tile& tile : tiles_) parts.push_back({&runner_.sessionOf(tile.crop), tile});
    return parts;
  }

 private:
  std::vector<Tile> tiles_;
  TileRunner runner_;
};

class NeededParts : public FrameRunner {
 public:
  NeededParts(Gpu& gpu, const NetworkModel& model, std::vector<Tile> tiles, const SessionOptions& options,
              const SparseOptions& sparse)
      : runner_(gpu, model, options, std::move(tiles), sparse) {}
  bool run(const FrameInput& frame, std::span<float> output, const std::function<bool(double)>& progress) override {
    return runner_.run(frame, output, progress);
  }
  float exposure() const override { return runner_.exposure(); }
  const std::vector<uint64_t>& lostPixels() const override { return runner_.lostPixels(); }
  std::vector<DispatchTime> times() const override { return runner_.runner().times(); }
  uint64_t byteSize() const override { return runner_.runner().byteSize(); }
  const SparseRunner* sparse() const override { return &runner_; }

 private:
  SparseRunner runner_;
};

}  // namespace

std::unique_ptr<FrameRunner> wholeRunner(Gpu& gpu, const NetworkModel& model, FrameShape frame,
                                         const SessionOptions& options) {
  return std::make_unique<WholeFrame>(gpu, model, frame, options);
}

std::unique_ptr<FrameRunner> tiledRunner(Gpu& gpu, const NetworkModel& model, std::vector<Tile> tiles,
                                         const SessionOptions& options) {
  return std::make_unique<TiledFrame>(gpu, model, std::move(tiles), options);
}

std::unique_ptr<FrameRunner> partsRunner(Gpu& gpu, const NetworkModel& model, std::vector<Tile> tiles,
                                         const SessionOptions& options, const SparseOptions& sparse) {
  return std::make_unique<NeededParts>(gpu, model, std::move(tiles), options, sparse);
}

std::function<bool(size_t, size_t)> countingShare(const std::function<bool(double)>& progress) {
  if (!progress) return nullptr;
  return [&progress](size_t done, size_t total) {
    return progress(static_cast<double>(done) / static_cast<double>(total));
  };
}

}  // namespace xrds
