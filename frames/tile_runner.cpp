#include "frames/tile_runner.h"

#include <algorithm>

namespace xrds {
namespace {

uint64_t pixelCount(const Rectangle& rectangle) { return uint64_t{rectangle.width} * rectangle.height; }

}  // namespace

TileRunner::TileRunner(Gpu& gpu, NetworkModel model, const SessionOptions& options)
    : gpu_(gpu), model_(std::move(model)), options_(options) {
  options_.autoExposure = false;
}

void TileRunner::prepare(std::span<const Tile> tiles) {
  std::vector<Size> sizes;
  for (const Tile& tile : tiles) sizes.emplace_back(tile.crop.height, tile.crop.width);
  const auto area = [](const Size& size) { return uint64_t{size.first} * size.second; };
  std::sort(sizes.begin(), sizes.end(),
            [&](const Size& a, const Size& b) { return area(a) != area(b) ? area(a) > area(b) : a > b; });
  sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
  for (const Size& size : sizes) {
    if (size == largestSize_ || others_.contains(size)) continue;
    const FrameShape shape{size.first, size.second};
    SessionOptions options = options_;
    if (largest_ && area(size) <= area(largestSize_)) {
      options.lender = largest_.get();
      others_.emplace(size, std::make_unique<Session>(gpu_, model_, shape, options));
      continue;
    }
    others_.clear();
    largest_.reset();
    largest_ = std::make_unique<Session>(gpu_, model_, shape, options);
    largestSize_ = size;
  }
}

Session& TileRunner::sessionOf(const Rectangle& crop) {
  const Size size{crop.height, crop.width};
  return size == largestSize_ ? *largest_ : *others_.at(size);
}

bool TileRunner::run(const FrameInput& frame, std::span<const Tile> tiles, std::span<float> output,
                     const std::function<bool(double)>& progress) {
  times_.clear();
  lostPixels_.clear();
  if (tiles.empty()) return true;
  prepare(tiles);
  exposure_ = frame.exposure ? *frame.exposure : exposureOf(gpu_, frame.colour, largest_->arena());
  FrameInput exposed = frame;
  exposed.exposure = exposure_;
  double total = 0, done = 0;
  for (const Tile& tile : tiles) total += static_cast<double>(pixelCount(tile.crop));
  for (const Tile& tile : tiles) {
    const auto share = static_cast<double>(pixelCount(tile.crop));
    const auto report = [&](size_t finished, size_t count) {
      return progress((done + share * static_cast<double>(finished) / static_cast<double>(count)) / total);
    };
    Session& session = sessionOf(tile.crop);
    session.uploadPart(exposed, tile.crop.x, tile.crop.y);
    if (!session.replay(progress ? std::function<bool(size_t, size_t)>(report) : nullptr)) return false;
    store(session, tile, frame, output);
    addTimes(session);
    done += share;
  }
  std::sort(lostPixels_.begin(), lostPixels_.end());
  return true;
}

// Writes the inner part of a tile to the output and to the means of the layers.
void TileRunner::store(const Session& session, const Tile& tile, const FrameInput& frame, std::span<float> output) {
  const size_t s = model_.config().scale, width = frame.colour.width * s;
  const size_t left = static_cast<size_t>(tile.inner.x - tile.crop.x) * s, top = (tile.inner.y - tile.crop.y) * s;
  const size_t columns = tile.inner.width * s, rows = tile.inner.height * s;
  // Hands over the pixels of each row that are of the inner part, and which pixel of the output the first one is.
  const auto inner = [&](auto&& store) {
    return [&, store](uint32_t row, std::span<const float> pixels) {
      if (row < top || row >= top + rows) return;
      const uint64_t begin = (tile.inner.y * s + row - top) * width + static_cast<size_t>(tile.inner.x) * s;
      store(pixels.subspan(4 * left, 4 * columns), begin);
    };
  };
  session.downloadRows(
      inner([&](std::span<const float> pixels, uint64_t first) { storeRow(pixels, first, output, lostPixels_); }));
  for (size_t i = 0; i < frame.layers.size(); ++i)
    session.downloadLayerRows(i, inner([&](std::span<const float> pixels, uint64_t first) {
                                for (size_t x = 0; x < columns; ++x)
                                  std::copy_n(&pixels[4 * x], 3, &frame.layers[i].mean[3 * (first + x)]);
                              }));
}

void TileRunner::addTimes(const Session& session) {
  for (DispatchTime& time : session.times()) {
    const auto known = std::find_if(times_.begin(), times_.end(), [&](const DispatchTime& row) {
      return row.label == time.label && row.program == time.program;
    });
    if (known == times_.end()) {
      times_.push_back(std::move(time));
      continue;
    }
    known->multiplyAdds += time.multiplyAdds;
    known->byteSize += time.byteSize;
    known->microseconds += time.microseconds;
  }
}

uint64_t TileRunner::byteSize() const {
  uint64_t sum = largest_ ? largest_->ownByteSize() : 0;
  for (const auto& [size, session] : others_) sum += session->ownByteSize();
  return sum;
}

}  // namespace xrds
