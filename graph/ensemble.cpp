#include "graph/ensemble.h"

#include <algorithm>
#include <cmath>

#include "xrds/error.h"

namespace xrds {
namespace {

constexpr Mirror kMirrors[] = {{true, false}, {false, true}, {true, true}, {}};

}  // namespace

std::span<const Mirror> mirrorsOf(uint32_t passes) {
  if (passes != 1 && passes != 2 && passes != 4)
    throw Error("An ensemble of " + std::to_string(passes) + " passes was asked for, expected 1, 2 or 4.");
  return std::span(kMirrors).last(passes);
}

std::vector<float> mirrored(const PixelView& image, Mirror mirror, bool isNormal) {
  const float signX = isNormal && mirror.leftRight ? -1.f : 1.f, signY = isNormal && mirror.upsideDown ? -1.f : 1.f;
  std::vector<float> pixels(size_t{3} * image.width * image.height);
  for (uint64_t p = 0; p < pixels.size() / 3; ++p) {
    const float* from = image.pixels + mirroredPixel(p, image.width, image.height, mirror) * image.stride;
    pixels[3 * p] = signX * from[0];
    pixels[3 * p + 1] = signY * from[1];
    pixels[3 * p + 2] = from[2];
  }
  return pixels;
}

MirroredFrame::MirroredFrame(const PixelView& colour, std::span<const PixelView> auxiliary,
                             std::span<const std::string> inputs, Mirror mirror) {
  const auto add = [&](const PixelView& image, bool isNormal) {
    pixels_.push_back(mirrored(image, mirror, isNormal));
    views_.push_back({pixels_.back().data(), image.width, image.height});
  };
  add(colour, false);
  for (size_t i = 0; i < auxiliary.size(); ++i) add(auxiliary[i], inputs[i] == "normal");
}

uint64_t mirroredPixel(uint64_t pixel, uint32_t width, uint32_t height, Mirror mirror) {
  const uint64_t x = pixel % width, y = pixel / width;
  return (mirror.upsideDown ? height - 1 - y : y) * width + (mirror.leftRight ? width - 1 - x : x);
}

EnsembleMean::EnsembleMean(uint32_t width, uint32_t height, Transfer transfer)
    : width_(width), height_(height), transfer_(transfer), sum_(size_t{3} * width * height) {}

void EnsembleMean::add(std::span<const float> result, Mirror mirror, float exposure) {
  for (uint64_t p = 0; p < sum_.size() / 3; ++p) {
    const float* from = &result[3 * mirroredPixel(p, width_, height_, mirror)];
    for (uint32_t c = 0; c < 3; ++c)
      sum_[3 * p + c] += transfer_ == Transfer::log1p ? std::log1p(std::max(0.f, exposure * from[c])) : from[c];
  }
  ++count_;
}

void EnsembleMean::write(std::span<float> output, float exposure) const {
  const float share = 1 / static_cast<float>(count_);
  for (size_t i = 0; i < sum_.size(); ++i) {
    const float mean = sum_[i] * share;
    output[i] = transfer_ == Transfer::log1p ? std::expm1(mean) / exposure : mean;
  }
}

}  // namespace xrds
