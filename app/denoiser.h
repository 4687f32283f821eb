#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "image/image.h"

namespace xrds {

/// The user's installed Open Image Denoise 2, loaded at run time. Not for several threads at once.
class Denoiser {
 public:
  /// Loads the library that the environment variable XRDS_OIDN names, else the one that the system finds, and opens its
  /// fastest device. Throws Error that says how to get it if there is none.
  Denoiser();
  ~Denoiser();
  Denoiser(const Denoiser&) = delete;
  Denoiser& operator=(const Denoiser&) = delete;

  /// "Open Image Denoise 2.5.1".
  const std::string& name() const { return name_; }

  /// The radiance [h, w, 3] without its noise, with the help of albedo and normal [h, w, 3] that have none. Either may
  /// be null, the normal must be where there is no albedo. The mean of so many `passes` over mirrored images
  /// (mirrorsOf()), whose errors differ. Throws Error.
  Image denoised(const Image& colour, const Image* albedo, const Image* normal, uint32_t passes = 1) const;

  /// Albedo and normal [h, w, 3] without their noise, each by a filter of its own, as the manual of Open Image Denoise
  /// advises for the best result. What an albedo has above 1, as that of lights may, stays as it is. Throws Error.
  Image denoisedAlbedo(const Image& albedo) const;
  Image denoisedNormal(const Image& normal) const;

 private:
  struct Library;
  std::unique_ptr<Library> library_;
  std::string name_;
};

}  // namespace xrds
