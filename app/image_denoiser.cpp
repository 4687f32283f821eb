#include "app/image_denoiser.h"

#include <span>
#include <vector>

#include "image/image_view.h"
#include "xrds/denoised_first.h"

namespace xrds {
namespace {

Image copyOf(const PixelView& view) {
  return {static_cast<int>(view.width), static_cast<int>(view.height), 3, mirrored(view, {}, false)};
}

}  // namespace

Image ImageDenoiser::denoised(const Image& colour, const Image* albedo, const Image* normal, uint32_t passes) {
  std::vector<PixelView> guides;
  if (albedo) guides.push_back(viewOf(*albedo));
  if (albedo && normal) guides.push_back(viewOf(*normal));
  const auto denoise = [&](const PixelView& image, std::span<const PixelView> turned) {
    std::vector<Image> clean;
    for (const PixelView& guide : turned) clean.push_back(copyOf(guide));
    return colourWithoutNoise(copyOf(image), clean.empty() ? nullptr : &clean[0],
                              clean.size() < 2 ? nullptr : &clean[1])
        .pixels;
  };
  return {colour.width, colour.height, 3, denoising::denoisedRadiance(viewOf(colour), guides, passes, denoise)};
}

Image ImageDenoiser::denoisedAlbedo(const Image& albedo) {
  const auto denoise = [&](const PixelView& image) { return albedoWithoutNoise(copyOf(image)).pixels; };
  return {albedo.width, albedo.height, 3, denoising::denoisedAlbedo(viewOf(albedo), denoise)};
}

}  // namespace xrds
