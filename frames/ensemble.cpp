#include "frames/ensemble.h"

#include <algorithm>
#include <cmath>

#include "xrds/auxiliary_input.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr Mirror kMirrors[] = {{true, false, true}, {false, true, true}, {true, true, true}, {false, false, true},
                               {true, false},       {false, true},       {true, true},       {}};

bool isDirection(const std::string& input) {
  const AuxiliaryInput* known = findAuxiliaryInput(input);
  return known && known->isDirection;
}

}  // namespace

std::span<const Mirror> mirrorsOf(uint32_t passes) {
  if (passes != 1 && passes != 2 && passes != 4 && passes != 8)
    throw Error("An ensemble of " + std::to_string(passes) + " passes was asked for, expected 1, 2, 4 or 8.");
  return std::span(kMirrors).last(passes);
}

std::vector<float> mirrored(const PixelView& image, Mirror mirror, bool isNormal) {
  const uint32_t width = mirror.transposed ? image.height : image.width;
  const uint32_t height = mirror.transposed ? image.width : image.height;
  const bool turnsAxes = isNormal && mirror.transposed;
  const float signX = isNormal && mirror.leftRight != mirror.transposed ? -1.f : 1.f;
  const float signY = isNormal && mirror.upsideDown != mirror.transposed ? -1.f : 1.f;
  std::vector<float> pixels(size_t{3} * width * height);
  for (uint64_t p = 0; p < pixels.size() / 3; ++p) {
    const float* from = image.pixels + mirroredPixel(p, width, height, mirror) * image.stride;
    pixels[3 * p] = signX * from[turnsAxes ? 1 : 0];
    pixels[3 * p + 1] = signY * from[turnsAxes ? 0 : 1];
    pixels[3 * p + 2] = from[2];
  }
  return pixels;
}

MirroredFrame::MirroredFrame(const PixelView& colour, std::span<const PixelView> auxiliary,
                             std::span<const std::string> inputs, Mirror mirror) {
  const auto add = [&](const PixelView& image, bool isNormal) {
    pixels_.push_back(mirrored(image, mirror, isNormal));
    const bool turned = mirror.transposed;
    views_.push_back({pixels_.back().data(), turned ? image.height : image.width, turned ? image.width : image.height});
  };
  add(colour, false);
  for (size_t i = 0; i < auxiliary.size(); ++i) add(auxiliary[i], isDirection(inputs[i]));
}

uint64_t mirroredPixel(uint64_t pixel, uint32_t width, uint32_t height, Mirror mirror) {
  const uint64_t x = mirror.leftRight ? width - 1 - pixel % width : pixel % width;
  const uint64_t y = mirror.upsideDown ? height - 1 - pixel / width : pixel / width;
  return mirror.transposed ? x * height + y : y * width + x;
}

EnsembleMean::EnsembleMean(uint32_t width, uint32_t height, Transfer transfer)
    : width_(width), height_(height), transfer_(transfer), sum_(size_t{3} * width * height) {}

void EnsembleMean::add(std::span<const float> result, Mirror mirror, float exposure) {
  const uint32_t width = mirror.transposed ? height_ : width_, height = mirror.transposed ? width_ : height_;
  for (uint64_t p = 0; p < sum_.size() / 3; ++p) {
    const float* from = &result[3 * p];
    float* to = &sum_[3 * mirroredPixel(p, width, height, mirror)];
    for (uint32_t c = 0; c < 3; ++c)
      to[c] += transfer_ == Transfer::log1p ? std::log1p(std::max(0.f, exposure * from[c])) : from[c];
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
