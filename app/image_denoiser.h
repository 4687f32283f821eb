#pragma once

#include <cstdint>
#include <string>

#include "image/image.h"

namespace xrds {

/// Takes the noise out of the images of a frame before an upscaler sees them: the installed library (Denoiser), or its
/// networks on a Vulkan device (DeviceDenoiser). Not for several threads at once.
class ImageDenoiser {
 public:
  ImageDenoiser() = default;
  virtual ~ImageDenoiser() = default;
  ImageDenoiser(const ImageDenoiser&) = delete;
  ImageDenoiser& operator=(const ImageDenoiser&) = delete;

  /// "Open Image Denoise 2.5.1".
  virtual std::string name() const = 0;

  /// The radiance [h, w, 3] without its noise, with the help of albedo and normal [h, w, 3] that have none. Either may
  /// be null, the normal must be where there is no albedo. The mean of so many `passes` over mirrored images
  /// (mirrorsOf()), whose errors differ. Throws Error.
  Image denoised(const Image& colour, const Image* albedo, const Image* normal, uint32_t passes = 1);

  /// Albedo and normal [h, w, 3] without their noise, each by a filter of its own, as the manual of Open Image Denoise
  /// advises for the best result. What an albedo has above 1, as that of lights may, stays as it is. Throws Error.
  Image denoisedAlbedo(const Image& albedo);
  Image denoisedNormal(const Image& normal) { return normalWithoutNoise(normal); }

 private:
  // Albedos are between 0 and 1, guides have no noise, and there is no normal without an albedo.
  virtual Image colourWithoutNoise(const Image& colour, const Image* albedo, const Image* normal) = 0;
  virtual Image albedoWithoutNoise(const Image& albedo) = 0;
  virtual Image normalWithoutNoise(const Image& normal) = 0;
};

}  // namespace xrds
