#include "api/c/layers.h"

#include "api/arguments.h"
#include "api/c/sized.h"

namespace xrds::c {

void Layers::add(const XrdsLayerSet& asGiven) {
  const XrdsLayerSet given = taken(asGiven, xrdsLayerSetDefault());
  LayerSet set;
  for (uint32_t i = 0; i < given.layerCount; ++i) {
    const XrdsLayer layer = taken(at(given.layers, i, "layers"), xrdsLayerDefault());
    set.lights.push_back({.light = read(layer.light, "light layer"),
                          .output = place(layer.output, "light layer's output"),
                          .colour = layer.colour,
                          .followsAlbedo = layer.followsAlbedo != 0});
  }
  for (uint32_t i = 0; i < given.colourCount; ++i) {
    const XrdsLayerColour pass = taken(at(given.colours, i, "colours"), xrdsLayerColourDefault());
    set.colours.push_back(
        {.low = read(pass.low, "low-resolution colour pass"), .output = place(pass.output, "colour pass's output")});
    if (pass.full.channels[0]) set.colours.back().full = read(pass.full, "full-resolution colour pass");
  }
  if (given.whole) set.whole = read(*given.whole, "whole of the layers");
  sets_.push_back(std::move(set));
}

PixelView Layers::read(const XrdsImage& image, const std::string& what) {
  return images_.emplace_back(image, what).view();
}

std::span<float> Layers::place(const XrdsImage& image, const std::string& what) {
  checkImage(image, what, 3);
  if (image.width != width_ || image.height != height_)
    throw InvalidArgument("The " + what + " is " + sizeText(image.width, image.height) + " pixels, expected " +
                          sizeText(width_, height_) + ".");
  const size_t numbers = size_t{3} * image.width * image.height;
  if (isPacked(image)) return {static_cast<float*>(image.channels[0]), numbers};
  return results_.emplace_back(Result{image, std::vector<float>(numbers)}).pixels;
}

void Layers::write() const {
  for (const Result& result : results_)
    for (uint32_t c = 0; c < 3; ++c) writeChannel(result.image, c, &result.pixels[c], 3);
}

}  // namespace xrds::c

XrdsLayer xrdsLayerDefault() { return {.structSize = sizeof(XrdsLayer), .colour = -1, .followsAlbedo = 1}; }

XrdsLayerColour xrdsLayerColourDefault() { return {.structSize = sizeof(XrdsLayerColour)}; }

XrdsLayerSet xrdsLayerSetDefault() { return {.structSize = sizeof(XrdsLayerSet)}; }
