#include "cli/alpha.h"

#include <algorithm>

#include "cli/progress.h"

namespace xrds {

Image upscaleAlpha(AlphaUpscaler& upscaler, const Image& alpha, int scale) {
  std::vector<float> opacity(alpha.pixelCount());
  for (size_t p = 0; p < opacity.size(); ++p) opacity[p] = alpha.pixels[p * alpha.channels];
  Image result(alpha.width * scale, alpha.height * scale, 1);
  result.pixels = upscaler.run(opacity, [](double) { return !interrupted(); });
  stopIfInterrupted();
  return result;
}

Image withAlpha(const Image& colour, const Image& alpha) {
  Image joined(colour.width, colour.height, 4);
  for (size_t p = 0; p < joined.pixelCount(); ++p) {
    std::copy_n(&colour.pixels[3 * p], 3, &joined.pixels[4 * p]);
    joined.pixels[4 * p + 3] = alpha.pixels[p];
  }
  return joined;
}

}  // namespace xrds
