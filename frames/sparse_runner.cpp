#include "frames/sparse_runner.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "frames/quiet_windows.h"
#include "frames/window_cover.h"
#include "xrds/error.h"

namespace xrds {
namespace {

// A window in which log(1 + e r) spans this many bounds changes by less than one bound: bench/skip.md.
constexpr float kSpanOverBound = 4;
constexpr float kHeldExposure = 0.02f;

// The size of the frame that a grid of tiles covers.
FrameShape frameOf(const std::vector<Tile>& grid) {
  const Rectangle& last = grid.back().inner;
  return {last.y + last.height, static_cast<uint32_t>(last.x) + last.width};
}

// To the bit, so that a NaN equals itself.
// NOLINTBEGIN(bugprone-suspicious-memory-comparison)
bool sameRow(const float* a, uint32_t strideA, const float* b, uint32_t count) {
  if (strideA == 3) return std::memcmp(a, b, sizeof(float) * 3 * count) == 0;
  for (uint32_t i = 0; i < count; ++i)
    if (std::memcmp(a + size_t{i} * strideA, b + size_t{3} * i, 3 * sizeof(float)) != 0) return false;
  return true;
}
// NOLINTEND(bugprone-suspicious-memory-comparison)

// Marks the windows in which the image differs from the packed one; `side` is theirs in its pixels.
void markDifferences(const PixelView& image, const std::vector<float>& before, uint32_t side, WindowMask& changed) {
  for (uint32_t y = 0; y < image.height; ++y)
    for (uint32_t column = 0; column < changed.columns; ++column) {
      uint8_t& mark = changed.at(y / side, column);
      const uint32_t x = column * side;
      const size_t pixel = size_t{y} * image.width + x;
      if (!mark)
        mark = !sameRow(image.pixels + pixel * image.stride, image.stride, &before[3 * pixel],
                        std::min(side, image.width - x));
    }
}

// Marks every window that is at most `windows` rows and columns from a marked one.
WindowMask spread(const WindowMask& mask, uint32_t windows) {
  WindowMask wide = mask;
  for (uint32_t row = 0; row < mask.rows; ++row)
    for (uint32_t column = 0; column < mask.columns; ++column) {
      if (!mask.at(row, column)) continue;
      const uint32_t left = column - std::min(column, windows), right = std::min(column + windows + 1, mask.columns);
      for (uint32_t r = row - std::min(row, windows); r < std::min(row + windows + 1, mask.rows); ++r)
        std::fill(&wide.at(r, left), &wide.at(r, left) + (right - left), uint8_t{1});
    }
  return wide;
}

}  // namespace

SparseRunner::SparseRunner(Gpu& gpu, const NetworkModel& model, const SessionOptions& session, std::vector<Tile> grid,
                           const SparseOptions& options)
    : config_(model.config()),
      runner_(gpu, model, session),
      grid_(std::move(grid)),
      options_(options),
      frame_(frameOf(grid_)),
      interpolated_(frame_, config_.window, false),
      kept_(frame_, config_.window, false) {
  const std::string why = whyNeverQuiet(config_);
  if (options.bound > 0 && !why.empty()) throw InvalidArgument("No window may be skipped: the model " + why + ".");
}

bool SparseRunner::run(const FrameInput& given, std::span<float> output, const std::function<bool(double)>& progress) {
  FrameInput frame = given;
  exposure_ = (frame.exposure ? *frame.exposure : exposureOnHost(frame.colour)).value;
  if (!frame.exposure && last_ && std::abs(exposure_ / last_->exposure - 1) <= kHeldExposure)
    frame.exposure = exposure_ = last_->exposure;

  const bool comparable = last_ && frame.exposure && frame.exposure->value == last_->exposure;
  const WindowMask changed = comparable ? changedWindows(frame) : WindowMask(frame_, config_.window, true);
  WindowMask needed = changed;
  std::optional<QuietWindows> quiet;
  if (options_.bound > 0 && changed.count() > 0) {
    quiet.emplace(config_, frame.colour, frame.auxiliary, exposure_, kSpanOverBound * options_.bound);
    for (size_t i = 0; i < needed.marks.size(); ++i) needed.marks[i] &= quiet->needed().marks[i];
  }
  const std::vector<Tile> tiles = tilesOf(needed);
  if (!runner_.run(frame, tiles, output, progress)) return false;
  if (!tiles.empty()) exposure_ = runner_.exposure();
  lostPixels_ = runner_.lostPixels();

  const WindowMask outside = windowsOutside(tiles, frame_, config_.window);
  for (size_t i = 0; i < outside.marks.size(); ++i) {
    interpolated_.marks[i] = outside.marks[i] & changed.marks[i];
    kept_.marks[i] = outside.marks[i] & !changed.marks[i];
  }
  if (quiet) quiet->fill(interpolated_, output);
  if (kept_.count() > 0) copyKept(output);
  if (options_.keepUnchanged) remember(frame, output);
  return true;
}

WindowMask SparseRunner::changedWindows(const FrameInput& frame) const {
  WindowMask changed(frame_, config_.window, false);
  markDifferences(frame.colour, last_->inputs[0], config_.window, changed);
  for (size_t i = 0; i < frame.auxiliary.size(); ++i)
    markDifferences(frame.auxiliary[i], last_->inputs[i + 1], config_.window * config_.scale, changed);
  return spread(changed, options_.reach / config_.window);
}

std::vector<Tile> SparseRunner::tilesOf(const WindowMask& needed) {
  std::vector<Tile> tiles;
  double pixels = 0;
  for (const Tile& whole : grid_)
    for (const Tile& tile : coverWindows(needed, frame_, whole, config_.window, options_.halo)) {
      pixels += static_cast<double>(tile.crop.width) * tile.crop.height;
      tiles.push_back(tile);
    }
  work_ = pixels / (static_cast<double>(frame_.width) * frame_.height);
  return tiles;
}

void SparseRunner::copyKept(std::span<float> output) {
  const uint32_t side = config_.window * config_.scale, width = frame_.width * config_.scale;
  for (uint32_t y = 0; y < frame_.height * config_.scale; ++y)
    for (uint32_t column = 0; column < kept_.columns; ++column) {
      if (!kept_.at(y / side, column)) continue;
      const size_t first = size_t{3} * (size_t{y} * width + size_t{column} * side);
      std::copy_n(&last_->output[first], size_t{3} * std::min(side, width - column * side), &output[first]);
    }
  for (const uint64_t pixel : last_->lostPixels)
    if (kept_.at(static_cast<uint32_t>(pixel / width / side), static_cast<uint32_t>(pixel % width / side)))
      lostPixels_.push_back(pixel);
}

void SparseRunner::remember(const FrameInput& frame, std::span<const float> output) {
  if (!last_) last_ = Last{};
  last_->inputs.assign(1, packed(frame.colour));
  for (const PixelView& image : frame.auxiliary) last_->inputs.push_back(packed(image));
  last_->output.assign(output.begin(), output.end());
  last_->lostPixels = lostPixels_;
  last_->exposure = exposure_;
}

}  // namespace xrds
