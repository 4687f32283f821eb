#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "xrds/mirror.h"
#include "xrds/pixel_view.h"

/// What denoising a frame before it is upscaled is made of, whoever denoises: Upscaler::Denoisers, or the installed
/// library in the command. Results have three floats a pixel.
namespace xrds::denoising {

using Pixels = std::vector<float>;

/// The view of results.
inline PixelView viewOf(const Pixels& pixels, uint32_t width, uint32_t height) {
  return {pixels.data(), width, height};
}

/// An albedo from 0 to 1, as denoisers take it.
inline Pixels albedoInRange(const PixelView& albedo) {
  Pixels inside = mirrored(albedo, {}, false);
  for (float& value : inside) value = std::clamp(value, 0.F, 1.F);
  return inside;
}

/// An albedo, or a colour pass, without its noise: what it has above 1, as that of lights may, stays. `denoise` makes
/// of an image its pixels without noise.
template <class Denoise>
Pixels denoisedAlbedo(const PixelView& albedo, const Denoise& denoise) {
  const Pixels given = mirrored(albedo, {}, false), inside = albedoInRange(albedo);
  Pixels result = denoise(viewOf(inside, albedo.width, albedo.height));
  for (size_t i = 0; i < result.size(); ++i) result[i] += given[i] - inside[i];
  return result;
}

/// A radiance without its noise: the mean of so many passes over mirrored images (mirrorsOf()), whose errors differ.
/// guides: none, the albedo, or albedo and normal, without noise; `denoise` makes of an image and such guides, the
/// albedo from 0 to 1, its pixels without noise.
template <class Denoise>
Pixels denoisedRadiance(const PixelView& radiance, std::span<const PixelView> guides, uint32_t passes,
                        const Denoise& denoise) {
  const Pixels inside = guides.empty() ? Pixels() : albedoInRange(guides[0]);
  Pixels mean(size_t{3} * radiance.width * radiance.height);
  for (const Mirror mirror : mirrorsOf(passes)) {
    const uint32_t width = mirror.transposed ? radiance.height : radiance.width;
    const uint32_t height = mirror.transposed ? radiance.width : radiance.height;
    std::vector<Pixels> images{mirrored(radiance, mirror, false)};
    if (!guides.empty()) images.push_back(mirrored(viewOf(inside, radiance.width, radiance.height), mirror, false));
    if (guides.size() > 1) images.push_back(mirrored(guides[1], mirror, true));
    std::vector<PixelView> views;
    for (const Pixels& image : images) views.push_back(viewOf(image, width, height));
    const Pixels result = denoise(views.front(), std::span<const PixelView>(views).subspan(1));
    for (size_t p = 0; p < result.size() / 3; ++p)
      for (size_t c = 0; c < 3; ++c)
        mean[3 * mirroredPixel(p, width, height, mirror) + c] += result[3 * p + c] / static_cast<float>(passes);
  }
  return mean;
}

/// The means of scale x scale pixels: guides of the low-resolution colour.
inline Pixels boxMean(const PixelView& image, uint32_t scale) {
  const uint32_t width = image.width / scale, height = image.height / scale;
  Pixels mean(size_t{3} * width * height);
  const float share = 1.0F / static_cast<float>(scale * scale);
  for (uint32_t y = 0; y < height * scale; ++y)
    for (uint32_t x = 0; x < width * scale; ++x)
      for (uint32_t c = 0; c < 3; ++c)
        mean[3 * (size_t{y / scale} * width + x / scale) + c] +=
            share * image.pixels[(size_t{y} * image.width + x) * image.stride + c];
  return mean;
}

/// Between a render's colour and the sum of its layers, stored as halves; and of the colour what layers may lack: less
/// is taken as noise of the sum.
inline constexpr double kLayerRounding = 1.0 / 256, kLeastMissingLight = 0.01;

/// What of a colour is in none of its layers of light, and the share of the colour that they are.
struct RestOfLayers {
  Pixels pixels;
  double share = 1;
};

/// Of the colour and the radiance of each layer, finite and without negative values.
inline RestOfLayers restOfLayers(std::span<const float> colour, std::span<const Pixels> layers) {
  RestOfLayers rest{{colour.begin(), colour.end()}};
  double missing = 0, all = 0, given = 0;
  for (const Pixels& layer : layers)
    for (size_t i = 0; i < layer.size(); ++i) {
      rest.pixels[i] -= layer[i];
      given += layer[i];
    }
  for (size_t i = 0; i < colour.size(); ++i) {
    if (!(rest.pixels[i] > kLayerRounding * colour[i])) rest.pixels[i] = 0;
    missing += rest.pixels[i];
    all += colour[i];
  }
  if (all > 0) rest.share = given / all;
  if (missing < kLeastMissingLight * all) std::fill(rest.pixels.begin(), rest.pixels.end(), 0.F);
  return rest;
}

/// What layers and the rest add up to.
inline Pixels sumOfLayers(Pixels rest, std::span<const Pixels> layers) {
  for (const Pixels& layer : layers)
    for (size_t i = 0; i < layer.size(); ++i) rest[i] += layer[i];
  return rest;
}

/// Whether an image has no light, so that there is nothing to denoise.
inline bool isBlack(std::span<const float> pixels) {
  return std::none_of(pixels.begin(), pixels.end(), [](float value) { return value > 0; });
}

}  // namespace xrds::denoising
