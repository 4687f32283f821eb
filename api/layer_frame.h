#pragma once

#include <array>

#include "api/finite_image.h"
#include "frames/frame_input.h"
#include "network/config.h"
#include "network/frame_shape.h"
#include "xrds/layers.h"

namespace xrds {

/// Throws InvalidArgument if a layer does not fit the frame.
void checkLayers(const NetworkConfig& config, FrameShape frame, const LayerSet& layers);

/// The images that a run filters for the layers: their lights, their colours, what of the whole is none of them and,
/// of models that take an albedo, the means of that. None of a denoiser of colours, whose layers only share its
/// picture.
uint32_t layerImageCount(const NetworkConfig& config, const LayerSet& layers);

/// The layers of one frame: what of them is filtered, and how they share the picture.
class LayerFrame {
 public:
  /// The images must outlive it. `auxiliary`: finite, in the model's order.
  LayerFrame(const NetworkConfig& config, FrameShape frame, const LayerSet& layers, const PixelView& colour,
             std::span<const PixelView> auxiliary);

  /// What is to be filtered, and the places of the results: outputs of the layers, where they stay until share(). Of a
  /// denoiser nothing: there the layers lie as they are given.
  std::vector<LayerImage> images();

  /// Makes the layers out of what was filtered, so that they sum to the picture [s h, s w, 3]: with A a filtered light,
  /// F its filtered colour or albedo, f that of the pixel, C = A f / F its guess, the layer is picture C / sum C.
  LayerReport share(std::span<const float> picture);

 private:
  struct Factor {  // what a light is demodulated by
    const float* mean = nullptr;
    PixelView full;
    double floor = 0, most = 0;  // of albedos: added to them, and the most that counts; most = 0: no limit
  };
  Factor factorOf(const LightLayer& layer) const;
  double guess(const Factor& factor, double light, size_t pixel, uint32_t c) const;
  void sharePixel(std::span<const float> picture, size_t pixel, LayerReport& report);
  void splitPixel(size_t pixel, LayerReport& report);
  void makeRest(const PixelView& whole);

  const NetworkConfig& config_;
  const LayerSet& layers_;
  std::vector<Image> filtered_;      // in the order of images()
  std::vector<FiniteImage> passes_;  // of the colours of full resolution that are there
  std::vector<PixelView> fulls_;     // of each colour; of one that is not there nothing
  std::vector<float> restMean_, albedoMean_;
  std::vector<Factor> factors_;                    // of each light, and of the rest
  std::vector<std::array<double, 3>> everywhere_;  // means of the lights over the frame
  std::vector<std::array<double, 3>> mostLight_;   // of each colour
  std::vector<double> guesses_;                    // of each light, and of the rest, at one pixel
  PixelView albedo_{};
  FrameShape frame_;
  double share_ = 1;
  bool isBlack_ = false;  // of what the layers are part of: what a network makes of it is noise
};

}  // namespace xrds
