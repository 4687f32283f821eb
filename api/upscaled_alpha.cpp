#include "api/frame_upscaler.h"
#include "xrds/alpha.h"

namespace xrds {

std::vector<float> upscaledAlpha(FrameUpscaler& bicubic, std::span<const float> alpha) {
  const FrameShape shape = bicubic.shape();
  const uint32_t scale = bicubic.config().scale;
  std::vector<float> spread(3 * alpha.size());
  for (size_t i = 0; i < spread.size(); ++i) spread[i] = alpha[i / 3];
  std::vector<float> upscaled(spread.size() * scale * scale), result(upscaled.size() / 3);
  bicubic.run({spread.data(), shape.width, shape.height}, {}, upscaled, {});
  for (size_t i = 0; i < result.size(); ++i) result[i] = snappedAlpha(upscaled[3 * i]);
  return result;
}

}  // namespace xrds
