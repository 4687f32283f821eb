#pragma once

#include <memory>
#include <string>

#include "app/image_denoiser.h"

namespace xrds {

/// The user's installed Open Image Denoise 2, loaded at run time. Not for several threads at once.
class Denoiser : public ImageDenoiser {
 public:
  /// Loads the library that the environment variable XRDS_OIDN names, else the one that the system finds, and opens its
  /// fastest device. Throws Error that says how to get it if there is none.
  Denoiser();
  ~Denoiser() override;

  std::string name() const override { return name_; }

 private:
  Image colourWithoutNoise(const Image& colour, const Image* albedo, const Image* normal) override;
  Image albedoWithoutNoise(const Image& albedo) override;
  Image normalWithoutNoise(const Image& normal) override;

  struct Library;
  std::unique_ptr<Library> library_;
  std::string name_;
};

}  // namespace xrds
