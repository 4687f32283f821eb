#include "graph/tile_runner.h"

#include <algorithm>

namespace xrds {
namespace {

uint64_t pixelCount(const Rectangle& rectangle) { return uint64_t{rectangle.width} * rectangle.height; }

// Copies a rectangle of the image, three floats a pixel, columns cyclic.
void copyPixels(const PixelView& image, int64_t x, uint32_t y, uint32_t width, uint32_t height,
                std::vector<float>& pixels) {
  pixels.resize(size_t{3} * width * height);
  float* to = pixels.data();
  for (uint32_t row = y; row < y + height; ++row) {
    const float* from = image.pixels + uint64_t{row} * image.width * image.stride;
    uint64_t column = static_cast<uint64_t>((x % image.width + image.width) % image.width);
    for (uint32_t i = 0; i < width; ++i, to += 3) {
      std::copy_n(from + column * image.stride, 3, to);
      if (++column == image.width) column = 0;
    }
  }
}

}  // namespace

TileRunner::TileRunner(Gpu& gpu, ModelWeights model, const SessionOptions& options)
    : gpu_(gpu), model_(std::move(model)), options_(options), auxiliary_(model_.config().auxInputs.size()) {
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

bool TileRunner::run(const FrameViews& frame, std::span<const Tile> tiles, std::span<float> output,
                     const std::function<bool(double)>& progress) {
  times_.clear();
  lostPixels_.clear();
  if (tiles.empty()) return true;
  prepare(tiles);
  const float given = frame.exposure.value_or(1.f);
  exposure_ = frame.exposure ? FrameExposure{given, 1 / given} : exposureOf(gpu_, frame.colour, largest_->arena());
  double total = 0, done = 0;
  for (const Tile& tile : tiles) total += static_cast<double>(pixelCount(tile.crop));
  for (const Tile& tile : tiles) {
    const auto share = static_cast<double>(pixelCount(tile.crop));
    const auto report = [&](size_t finished, size_t count) {
      return progress((done + share * static_cast<double>(finished) / static_cast<double>(count)) / total);
    };
    load(frame, tile.crop);
    FrameInput input{colour_, {auxiliary_.begin(), auxiliary_.end()}, exposure_.value, exposure_.inverse};
    Session& session = sessionOf(tile.crop);
    result_.resize(3 * session.graph().output.pixelCount());
    if (!session.run(input, result_, progress ? std::function<bool(size_t, size_t)>(report) : nullptr)) return false;
    store(frame, tile, output);
    addLostPixels(session, frame, tile);
    addTimes(session);
    done += share;
  }
  return true;
}

void TileRunner::load(const FrameViews& frame, const Rectangle& crop) {
  const uint32_t s = model_.config().scale;
  copyPixels(frame.colour, crop.x, crop.y, crop.width, crop.height, colour_);
  for (size_t i = 0; i < auxiliary_.size(); ++i)
    copyPixels(frame.auxiliary[i], int64_t{crop.x} * s, crop.y * s, crop.width * s, crop.height * s, auxiliary_[i]);
}

void TileRunner::store(const FrameViews& frame, const Tile& tile, std::span<float> output) const {
  const uint32_t s = model_.config().scale;
  const size_t left = static_cast<size_t>(tile.inner.x - tile.crop.x) * s, top = (tile.inner.y - tile.crop.y) * s;
  for (size_t row = 0; row < size_t{tile.inner.height} * s; ++row) {
    const size_t from = (top + row) * tile.crop.width * s + left;
    const size_t to = (size_t{tile.inner.y} * s + row) * frame.colour.width * s + static_cast<size_t>(tile.inner.x) * s;
    std::copy_n(&result_[3 * from], size_t{3} * tile.inner.width * s, &output[3 * to]);
  }
}

void TileRunner::addLostPixels(const Session& session, const FrameViews& frame, const Tile& tile) {
  const int64_t s = model_.config().scale, width = s * tile.crop.width;
  const int64_t left = s * tile.inner.x, top = s * tile.inner.y;
  for (const uint64_t pixel : session.lostPixels()) {
    const int64_t x = s * tile.crop.x + static_cast<int64_t>(pixel) % width;
    const int64_t y = s * tile.crop.y + static_cast<int64_t>(pixel) / width;
    if (x >= left && x < left + s * tile.inner.width && y >= top && y < top + s * tile.inner.height)
      lostPixels_.push_back(static_cast<uint64_t>(y * s * frame.colour.width + x));
  }
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
