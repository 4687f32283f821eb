#include "xrds/mirror.h"

#include <string>

#include "xrds/error.h"

namespace xrds {
namespace {

constexpr Mirror kMirrors[] = {{true, false, true}, {false, true, true}, {true, true, true}, {false, false, true},
                               {true, false},       {false, true},       {true, true},       {}};

}  // namespace

std::span<const Mirror> mirrorsOf(uint32_t passes) {
  if (passes != 1 && passes != 2 && passes != 4 && passes != 8)
    throw InvalidArgument("An ensemble of " + std::to_string(passes) + " passes was asked for, expected 1, 2, 4 or 8.");
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

uint64_t mirroredPixel(uint64_t pixel, uint32_t width, uint32_t height, Mirror mirror) {
  const uint64_t x = mirror.leftRight ? width - 1 - pixel % width : pixel % width;
  const uint64_t y = mirror.upsideDown ? height - 1 - pixel / width : pixel / width;
  return mirror.transposed ? x * height + y : y * width + x;
}

}  // namespace xrds
