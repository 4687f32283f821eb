#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "app/frame.h"
#include "xrds/xrds.hpp"

namespace xrds {

/// What one frame took: the sum of its dispatches on the device (0 without timestamps), and the wall clock from the
/// upload of the images to the download of the result.
struct FrameSeconds {
  double device = 0, wall = 0;
  double best() const { return device > 0 ? device : wall; }
};

/// A model that is measured on many frames: planned and recorded once for each frame shape, on one device, which must
/// outlive it.
class EngineMethod {
 public:
  /// ensemble: as Upscaler::Options.
  EngineMethod(std::string name, Model model, bool trained, uint32_t ensemble = 1)
      : name_(std::move(name)), model_(std::move(model)), trained_(trained), ensemble_(ensemble) {}
  const std::string& name() const { return name_; }
  const Model& model() const { return model_; }
  bool trained() const { return trained_; }
  uint32_t ensemble() const { return ensemble_; }

  /// Upscales a frame that has the model's auxiliary inputs and adds to `seconds` its times. The first frame of a shape
  /// runs twice and the second time counts: the first one may compile. Pixels that are not finite are filled from their
  /// neighbours, with a warning, as `xrds upscale` does. Throws Error, or Failure when interrupted.
  /// denoised: as Upscaler::Options::denoisedColour, the same for each frame.
  Image run(Device& device, const Frame& frame, bool fp16, bool denoised, FrameSeconds& seconds);

 private:
  std::string name_;
  Model model_;
  bool trained_;
  uint32_t ensemble_;
  std::map<std::pair<uint32_t, uint32_t>, Upscaler> upscalers_{};  // by width and height
};

/// The rivals without a network. At scale 1 bicubic and demodulated bicubic leave the image as it is, so that only
/// guided, then a filter, is left.
std::vector<EngineMethod> untrainedMethods(int scale);

/// A model by name or file, its name followed by "ensemble N" if that is not 1. Throws Error if it cannot be read, has
/// another scale or unknown inputs.
EngineMethod trainedMethod(const std::string& nameOrFile, int scale, uint32_t ensemble = 1);

}  // namespace xrds
