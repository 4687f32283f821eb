#include "xrds/temporal_filter.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "api/arguments.h"
#include "api/state.h"
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

/// Writes the three channels of an image to packed pixels from `channel` on, each through `value`.
template <class Value>
void pack(const PixelView& image, std::vector<float>& packed, uint32_t channel, Value&& value) {
  if (!image.pixels) return;
  for (size_t p = 0; p < packed.size() / kChannels; ++p)
    for (uint32_t c = 0; c < 3; ++c) packed[p * kChannels + channel + c] = value(image.pixels[p * image.stride + c]);
}

float radianceOf(float value) { return value > 0 ? std::min(value, kMostRadiance) : 0; }  // 0 of NaN
float finiteOf(float value) { return std::isfinite(value) ? value : 0; }
float reflectanceOf(float value) { return value > 0 ? std::min(value, shader::kAlbedoMax) : 0; }

void packCounts(std::span<const float> counts, std::vector<float>& packed) {
  for (size_t p = 0; p < packed.size() / kChannels; ++p)
    packed[p * kChannels + 3] = counts.empty() ? 1 : std::min(radianceOf(counts[p]), kMostCount);
}

std::vector<float> packedMotion(std::span<const float> motion) {
  std::vector<float> packed(2 * motion.size());
  for (size_t i = 0; i < motion.size(); ++i)
    packed[4 * (i / 2) + i % 2] = std::isfinite(motion[i]) ? std::clamp(motion[i], -kGone, kGone) : kGone;
  return packed;
}

PackedFrame packedFrame(const TemporalFilter::Frame& frame, Size low, Size full) {
  PackedFrame packed{std::vector<float>(low.pixels() * kChannels), std::vector<float>(full.pixels() * kChannels)};
  pack(frame.colour, packed.low, 0, radianceOf);
  packCounts(frame.lowCounts, packed.low);
  pack(frame.fullColour, packed.full, 0, radianceOf);
  packCounts(frame.fullCounts, packed.full);
  pack(frame.albedo, packed.full, 4, reflectanceOf);
  pack(frame.normal, packed.full, 8, finiteOf);
  for (size_t p = 0; p < frame.depth.size(); ++p) {
    const float distance = frame.depth[p];
    packed.full[p * kChannels + 7] = distance > 0 && distance < kFarthest ? 1 / distance : 0;
  }
  packed.toPrevious = packedMotion(frame.toPrevious);
  packed.toNext = packedMotion(frame.toNext);
  return packed;
}

std::vector<float> channelsOf(std::span<const float> pixels, uint32_t stride, uint32_t first, uint32_t count) {
  std::vector<float> channels(pixels.size() / stride * count);
  for (size_t p = 0; p < pixels.size() / stride; ++p)
    std::copy_n(&pixels[p * stride + first], count, &channels[p * count]);
  return channels;
}

}  // namespace

struct TemporalFilter::State {
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

TemporalFilter::TemporalFilter(Device& device, uint32_t width, uint32_t height, uint32_t scale) {
  if (width == 0 || height == 0 || scale == 0 || scale > 16 || (scale & (scale - 1)) != 0)
    throw InvalidArgument("A temporal filter of " + sizeText(width, height) + " pixels and scale " +
                          std::to_string(scale) + " was asked for; the scale must be 1, 2, 4, 8 or 16.");
  state_.reset(new State{
      {width, height}, {scale * width, scale * height}, HistoryMerger(device.state_->gpu, height, width, scale)});
}

TemporalFilter::~TemporalFilter() = default;
TemporalFilter::TemporalFilter(TemporalFilter&&) noexcept = default;
TemporalFilter& TemporalFilter::operator=(TemporalFilter&&) noexcept = default;

TemporalFilter::Merged TemporalFilter::run(const Frame& present, std::span<const Frame> before,
                                           std::span<const Frame> after) {
  state_->check(present);
  std::vector<PackedFrame> packed;
  packed.reserve(before.size() + after.size());
  const auto chainOf = [&](std::span<const Frame> frames) {
    std::vector<const PackedFrame*> chain;
    for (const Frame& frame : frames) {
      state_->check(frame);
      chain.push_back(&packed.emplace_back(packedFrame(frame, state_->low, state_->full)));
    }
    return chain;
  };
  const auto past = chainOf(before), future = chainOf(after);
  std::vector<float> low(4 * state_->low.pixels()), full(kChannels * state_->full.pixels());
  state_->merger.run(packedFrame(present, state_->low, state_->full), past, future, low, full);
  Merged merged{.colour = channelsOf(low, 4, 0, 3),
                .lowCounts = channelsOf(low, 4, 3, 1),
                .fullCounts = channelsOf(full, kChannels, 3, 1)};
  if (present.fullColour.pixels) merged.fullColour = channelsOf(full, kChannels, 0, 3);
  if (present.albedo.pixels) merged.albedo = channelsOf(full, kChannels, 4, 3);
  if (present.normal.pixels) merged.normal = channelsOf(full, kChannels, 8, 3);
  return merged;
}

uint64_t TemporalFilter::deviceBytes() const { return state_->merger.deviceBytes(); }

}  // namespace xrds
