#include "api/finite_image.h"

#include <atomic>

#include "engine/parallel.h"
#include "frames/frame_input.h"
#include "image/repair.h"

namespace xrds {

Image imageOf(const PixelView& view) {
  return {static_cast<int>(view.width), static_cast<int>(view.height), 3, packed(view)};
}

namespace {

bool isFinite(const PixelView& image) {
  constexpr uint64_t kPixelsOfThread = 1 << 15;  // fewer are seen sooner than a thread starts
  std::atomic<bool> finite = true;
  inParallel(uint64_t{image.width} * image.height, kPixelsOfThread, [&](uint64_t begin, uint64_t end) {
    // Zero times a number is zero, unless it is infinite or none.
    float sum = 0;
    for (const float* rgb = image.pixels + begin * image.stride; begin < end; ++begin, rgb += image.stride)
      sum += 0 * rgb[0] + 0 * rgb[1] + 0 * rgb[2];
    if (sum != 0) finite = false;
  });
  return finite;
}

}  // namespace

FiniteImage::FiniteImage(const PixelView& given, PixelKind kind) : view_(given) {
  if (isFinite(given)) return;
  copy_ = imageOf(given);
  repaired_ = (kind == PixelKind::radiance ? repairRadiance(copy_) : repairNonFinite(copy_)).nonFinitePixels;
  view_ = {copy_.pixels.data(), given.width, given.height};
}

}  // namespace xrds
