#include "app/image_denoiser.h"

#include <span>
#include <utility>
#include <vector>

#include "image/image_view.h"
#include "xrds/denoised_first.h"

namespace xrds {
namespace {

Image imageOf(std::vector<float> pixels, int width, int height) {
  Image image(width, height, 0);
  image.channels = 3;
  image.pixels = std::move(pixels);
  return image;
}

Image copyOf(const PixelView& view) {
  return imageOf(mirrored(view, {}, false), static_cast<int>(view.width), static_cast<int>(view.height));
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
  return imageOf(denoising::denoisedRadiance(viewOf(colour), guides, passes, denoise), colour.width, colour.height);
}

Image ImageDenoiser::denoisedAlbedo(const Image& albedo) {
  const auto denoise = [&](const PixelView& image) { return albedoWithoutNoise(copyOf(image)).pixels; };
  return imageOf(denoising::denoisedAlbedo(viewOf(albedo), denoise), albedo.width, albedo.height);
}

}  // namespace xrds
