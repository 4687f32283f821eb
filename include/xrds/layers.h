#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "xrds/pixel_view.h"

namespace xrds {

/// A light of the low-resolution render that its colour is made of beside others: diffuse, emission, a light group.
struct LightLayer {
  PixelView light;            // [h, w, >= 3], linear; what is negative or not finite counts as repaired: 0, or filled
  std::span<float> output{};  // [s h, s w], three floats a pixel
  int colour = -1;  // the place in LayerSet::colours of the colour that multiplies it; -1: none, it is radiance
  /// Of one without a colour: whether it is demodulated by the albedo, as the picture is. Emission, environment and
  /// volumes are not.
  bool followsAlbedo = true;
};

/// A colour pass, such as Cycles' DiffCol: the light layers of its kind times it are their part of the picture.
struct LayerColour {
  PixelView low;              // [h, w, >= 3] of the low-resolution render
  PixelView full{};           // [s h, s w, >= 3] of the other one, repaired; absent: `low`, filtered
  std::span<float> output{};  // [s h, s w], three floats a pixel: `full`, raised where light would have no place
};

/// Layers that are upscaled with a picture so that they still add up to it; passes of Cycles are one set, light groups
/// another. Each is filtered by the kernels of the picture's base image, by its bicubic weights where the model has no
/// such kernels, times its colour or albedo of full resolution. What the network makes beyond that is shared out: each
/// layer gets its share of the picture, pixel by pixel and channel by channel. Of an upscaler with denoisers each goes
/// through these before. A denoiser (xrds/oidn_import.h) as the model filters no layers: give each without its noise,
/// and the sum of these as `whole`.
struct LayerSet {
  std::vector<LightLayer> lights;
  std::vector<LayerColour> colours{};
  /// What the layers are part of, [h, w, >= 3]; absent: the colour. Another one where the colour given to the network
  /// was merged or denoised and the layers were not.
  PixelView whole{};
};

/// What became of a set of layers.
struct LayerReport {
  /// The sum of the layers over what they are part of. Below 0.99 the missing part is taken as one more layer, which is
  /// not put out; else the layers are made to sum to the picture.
  double share = 0;
  uint64_t raisedColours = 0;  // pixels of colour passes that are not those given
  uint64_t unshared = 0;       // pixels with light of the picture in a channel in which all layers are black everywhere
};

}  // namespace xrds
