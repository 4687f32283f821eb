#pragma once

#include <string>
#include <vector>

#include "xrds/image_call.h"
#include "xrds/layers.h"

namespace xrds::call {

/// A set of layers as the C API has it. The set must outlive it.
class Layers {
 public:
  /// width x height: of the output. Throws InvalidArgument if an output has no room for that.
  Layers(const LayerSet& set, uint32_t width, uint32_t height) : whole_(image(set.whole, "whole")) {
    for (const LightLayer& light : set.lights) {
      XrdsLayer& given = layers_.emplace_back(xrdsLayerDefault());
      given.light = image(light.light, "light layer");
      given.output = output("output of light layer " + std::to_string(layers_.size() - 1), light.output, width, height);
      given.colour = light.colour;
      given.followsAlbedo = light.followsAlbedo;
    }
    for (const LayerColour& colour : set.colours) {
      XrdsLayerColour& given = colours_.emplace_back(xrdsLayerColourDefault());
      given.low = image(colour.low, "low-resolution colour pass");
      given.full = image(colour.full, "full-resolution colour pass");
      given.output =
          output("output of colour pass " + std::to_string(colours_.size() - 1), colour.output, width, height);
    }
  }
  /// Points into this object, which must stay where it is.
  XrdsLayerSet given() const {
    XrdsLayerSet set = xrdsLayerSetDefault();
    set.layerCount = static_cast<uint32_t>(layers_.size());
    set.colourCount = static_cast<uint32_t>(colours_.size());
    set.layers = layers_.data();
    set.colours = colours_.data();
    set.whole = whole_.channels[0] ? &whole_ : nullptr;
    return set;
  }

 private:
  std::vector<XrdsLayer> layers_;
  std::vector<XrdsLayerColour> colours_;
  XrdsImage whole_;
};

}  // namespace xrds::call
