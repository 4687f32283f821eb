#include "app/image_denoiser.h"

#include <algorithm>

#include "image/image_view.h"
#include "xrds/mirror.h"

namespace xrds {
namespace {

Image clampedToOne(Image image) {
  for (float& value : image.pixels) value = std::clamp(value, 0.0F, 1.0F);
  return image;
}

Image mirroredImage(const Image& image, Mirror mirror, bool isNormal) {
  Image result(mirror.transposed ? image.height : image.width, mirror.transposed ? image.width : image.height, 0);
  result.channels = 3;
  result.pixels = mirrored(viewOf(image), mirror, isNormal);
  return result;
}

}  // namespace

Image ImageDenoiser::denoised(const Image& colour, const Image* albedo, const Image* normal, uint32_t passes) {
  const Image inside = albedo ? clampedToOne(*albedo) : Image{};
  Image mean(colour.width, colour.height, 3);
  for (const Mirror mirror : mirrorsOf(passes)) {
    const Image images[] = {mirroredImage(colour, mirror, false), mirroredImage(inside, mirror, false),
                            normal ? mirroredImage(*normal, mirror, true) : Image{}};
    const Image result =
        colourWithoutNoise(images[0], albedo ? &images[1] : nullptr, albedo && normal ? &images[2] : nullptr);
    const auto width = static_cast<uint32_t>(result.width), height = static_cast<uint32_t>(result.height);
    for (size_t p = 0; p < result.pixelCount(); ++p)
      for (size_t c = 0; c < 3; ++c)
        mean.pixels[3 * mirroredPixel(p, width, height, mirror) + c] +=
            result.pixels[3 * p + c] / static_cast<float>(passes);
  }
  return mean;
}

Image ImageDenoiser::denoisedAlbedo(const Image& albedo) {
  const Image clamped = clampedToOne(albedo);
  Image result = albedoWithoutNoise(clamped);
  for (size_t i = 0; i < result.pixels.size(); ++i) result.pixels[i] += albedo.pixels[i] - clamped.pixels[i];
  return result;
}

}  // namespace xrds
