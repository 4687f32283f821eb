#include "api/temporal_filter.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "api/arguments.h"
#include "frames/history_merger.h"

namespace xrds {
namespace {

constexpr uint32_t kChannels = shader::kHistoryFrame;
constexpr float kMostRadiance = 1e30F;  // of what is merged
constexpr float kFarthest = 1e8F;       // distances from there on are background
constexpr float kGone = 1e6F;           // pixels of motion: out of every image
constexpr float kMostCount = 1e6F;

struct Size {
  uint32_t width, height;
  size_t pixels() const { return size_t{width} * height; }
};

void checkImage(const char* name, const PixelView& image, Size size, bool needed) {
  if (!image.pixels && !needed) return;
  if (!image.pixels || image.width != size.width || image.height != size.height || image.stride < 3)
    throw InvalidArgument("The " + std::string(name) + " of a frame to merge is " +
                          sizeText(image.width, image.height) + " pixels, expected " +
                          sizeText(size.width, size.height) + " of at least three floats.");
}

void checkNumbers(const char* name, std::span<const float> numbers, size_t expected) {
  if (!numbers.empty() && numbers.size() != expected)
    throw InvalidArgument("The " + std::string(name) + " of a frame to merge has " + std::to_string(numbers.size()) +
                          " numbers, expected " + std::to_string(expected) + ".");
}

float radianceOf(float value) { return value > 0 ? std::min(value, kMostRadiance) : 0; }  // 0 of NaN
float finiteOf(float value) { return std::isfinite(value) ? value : 0; }
float reflectanceOf(float value) { return value > 0 ? std::min(value, shader::kAlbedoMax) : 0; }

float countOf(std::span<const float> counts, size_t pixel) {
  return counts.empty() ? 1 : std::min(radianceOf(counts[pixel]), kMostCount);
}

float nearnessOf(std::span<const float> distances, size_t pixel) {
  if (distances.empty()) return 0;
  const float distance = distances[pixel];
  return distance > 0 && distance < kFarthest ? 1 / distance : 0;
}

/// Writes a pixel of an image, each channel through `value`; 0 where there is no image.
template <class Value>
void write(const PixelView& image, size_t pixel, float* to, Value&& value) {
  for (uint32_t c = 0; c < 3; ++c) to[c] = image.pixels ? value(image.pixels[pixel * image.stride + c]) : 0;
}

HistoryFrame::WriteRow motionRows(std::span<const float> motion) {
  if (motion.empty()) return {};
  return [motion](uint32_t y, std::span<float> row) {
    const float* from = &motion[y * row.size() / 2];
    for (size_t i = 0; i < row.size() / 2; ++i)
      row[4 * (i / 2) + i % 2] = std::isfinite(from[i]) ? std::clamp(from[i], -kGone, kGone) : kGone;
  };
}

// Reads the frame whenever it is called.
HistoryFrame historyFrame(const TemporalFilter::Frame& frame) {
  HistoryFrame rows;
  rows.low = [&frame](uint32_t y, std::span<float> row) {
    std::fill(row.begin(), row.end(), 0.F);
    size_t pixel = size_t{y} * row.size() / kChannels;
    for (float* to = row.data(); to != row.data() + row.size(); to += kChannels, ++pixel) {
      write(frame.colour, pixel, to, radianceOf);
      to[3] = countOf(frame.lowCounts, pixel);
    }
  };
  rows.full = [&frame](uint32_t y, std::span<float> row) {
    size_t pixel = size_t{y} * row.size() / kChannels;
    for (float* to = row.data(); to != row.data() + row.size(); to += kChannels, ++pixel) {
      write(frame.fullColour, pixel, to, radianceOf);
      to[3] = countOf(frame.fullCounts, pixel);
      write(frame.albedo, pixel, to + 4, reflectanceOf);
      to[7] = nearnessOf(frame.depth, pixel);
      write(frame.normal, pixel, to + 8, finiteOf);
      to[11] = 0;
    }
  };
  rows.toPrevious = motionRows(frame.toPrevious);
  rows.toNext = motionRows(frame.toNext);
  rows.hasFullColour = frame.fullColour.pixels != nullptr;
  return rows;
}

/// Takes three channels of each pixel of a row, from `channel` on, to their place in an image; nothing if that is
/// empty.
void take(std::span<const float> row, size_t stride, size_t channel, uint32_t y, std::vector<float>& image) {
  if (image.empty()) return;
  float* to = &image[y * (row.size() / stride) * 3];
  for (size_t i = channel; i < row.size(); i += stride, to += 3) std::copy_n(&row[i], 3, to);
}

void takeCounts(std::span<const float> row, size_t stride, uint32_t y, std::vector<float>& counts) {
  for (size_t i = 0; i < row.size() / stride; ++i) counts[y * (row.size() / stride) + i] = row[i * stride + 3];
}

}  // namespace

struct FrameMerger::State {
  Size low, full;
  HistoryMerger merger;

  void check(const Frame& frame) const {
    checkImage("colour", frame.colour, low, true);
    checkImage("full-resolution colour", frame.fullColour, full, false);
    checkImage("albedo", frame.albedo, full, false);
    checkImage("normal", frame.normal, full, false);
    checkNumbers("depth", frame.depth, full.pixels());
    checkNumbers("motion to the previous frame", frame.toPrevious, 2 * full.pixels());
    checkNumbers("motion to the next frame", frame.toNext, 2 * full.pixels());
    checkNumbers("low-resolution counts", frame.lowCounts, low.pixels());
    checkNumbers("full-resolution counts", frame.fullCounts, full.pixels());
  }
};

FrameMerger::FrameMerger(Gpu& gpu, uint32_t width, uint32_t height, uint32_t scale) {
  constexpr uint32_t kMostPixels = 1 << 24;  // to a side of the large images, as of an upscaler's output
  const auto fits = [&](uint32_t side) { return side > 0 && side <= kMostPixels / scale; };
  if (scale == 0 || scale > 16 || (scale & (scale - 1)) != 0 || !fits(width) || !fits(height))
    throw InvalidArgument(
        "A temporal filter of " + sizeText(width, height) + " pixels and scale " + std::to_string(scale) +
        " was asked for; the scale must be 1, 2, 4, 8 or 16, and each side of the large images 1 to " +
        std::to_string(kMostPixels) + " pixels.");
  state_ = std::make_unique<State>(
      State{{width, height}, {scale * width, scale * height}, HistoryMerger(gpu, height, width, scale)});
}

FrameMerger::~FrameMerger() = default;

TemporalFilter::Merged FrameMerger::run(const Frame& present, std::span<const Frame> before,
                                        std::span<const Frame> after) {
  state_->check(present);
  const auto chainOf = [&](std::span<const Frame> frames) {
    std::vector<HistoryFrame> chain;
    for (const Frame& frame : frames) {
      state_->check(frame);
      chain.push_back(historyFrame(frame));
    }
    return chain;
  };
  const auto past = chainOf(before), future = chainOf(after);
  const size_t low = state_->low.pixels(), full = state_->full.pixels();
  TemporalFilter::Merged merged;
  merged.colour.resize(3 * low);
  merged.lowCounts.resize(low);
  merged.fullCounts.resize(full);
  if (present.fullColour.pixels) merged.fullColour.resize(3 * full);
  if (present.albedo.pixels) merged.albedo.resize(3 * full);
  if (present.normal.pixels) merged.normal.resize(3 * full);
  state_->merger.run(
      historyFrame(present), past, future,
      [&](uint32_t y, std::span<const float> row) {
        take(row, 4, 0, y, merged.colour);
        takeCounts(row, 4, y, merged.lowCounts);
      },
      [&](uint32_t y, std::span<const float> row) {
        take(row, kChannels, 0, y, merged.fullColour);
        take(row, kChannels, 4, y, merged.albedo);
        take(row, kChannels, 8, y, merged.normal);
        takeCounts(row, kChannels, y, merged.fullCounts);
      });
  return merged;
}

uint64_t FrameMerger::deviceBytes() const { return state_->merger.deviceBytes(); }

}  // namespace xrds
