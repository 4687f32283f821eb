#include "api/layer_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "api/arguments.h"
#include "api/finite_image.h"
#include "image/repair.h"
#include "network/oidn.h"
#include "shaders/common/transfer.h"
#include "xrds/auxiliary_input.h"
#include "xrds/denoised_first.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr double kMostGain = 16;  // of the picture over the guesses, before unlikely places take light as well
constexpr float kMostFloat = std::numeric_limits<float>::max();
constexpr float kMostLight = 1e30F;  // of a layer, so that no sum of it leaves the range of a float

// Such a network has no kernels to filter layers by.
bool denoisesColours(const NetworkConfig& config) {
  const std::string image = denoisedImage(config);
  return image == "hdr" || image == "ldr";
}

double finite(float value) { return std::isfinite(value) ? std::max(value, 0.F) : 0; }

const float* pixelOf(const PixelView& image, size_t pixel) { return image.pixels + pixel * image.stride; }

Image repaired(const PixelView& view) {
  Image image = imageOf(view);
  repairRadiance(image);
  for (float& value : image.pixels) value = std::min(value, kMostLight);
  return image;
}

void checkSize(const std::string& what, const PixelView& image, uint32_t width, uint32_t height) {
  if (image.width != width || image.height != height)
    throw InvalidArgument(what + " is " + sizeText(image.width, image.height) + " pixels, expected " +
                          sizeText(width, height) + ".");
  if (!image.pixels || image.stride < 3)
    throw InvalidArgument(what + " has " + (image.pixels ? "fewer than three channels." : "no pixels."));
}

void checkRoom(const std::string& what, std::span<const float> output, size_t pixels) {
  if (output.size() != 3 * pixels || !output.data())
    throw InvalidArgument(what + " has room for " + std::to_string(output.size()) + " numbers, expected " +
                          std::to_string(3 * pixels) + ".");
}

}  // namespace

void checkLayers(const NetworkConfig& config, FrameShape frame, const LayerSet& layers) {
  const uint32_t width = config.scale * frame.width, height = config.scale * frame.height;
  const size_t pixels = size_t{width} * height;
  for (size_t i = 0; i < layers.lights.size(); ++i) {
    const LightLayer& layer = layers.lights[i];
    const std::string name = "Light layer " + std::to_string(i);
    checkSize(name, layer.light, frame.width, frame.height);
    checkRoom("The output of light layer " + std::to_string(i), layer.output, pixels);
    if (layer.colour < -1 || layer.colour >= static_cast<int>(layers.colours.size()))
      throw InvalidArgument(name + " is multiplied by colour " + std::to_string(layer.colour) + ", but there are " +
                            std::to_string(layers.colours.size()) + ", counted from 0.");
  }
  for (size_t i = 0; i < layers.colours.size(); ++i) {
    const std::string name = "colour pass " + std::to_string(i);
    checkSize("The low-resolution " + name, layers.colours[i].low, frame.width, frame.height);
    if (layers.colours[i].full.pixels) checkSize("The full-resolution " + name, layers.colours[i].full, width, height);
    checkRoom("The output of " + name, layers.colours[i].output, pixels);
  }
  if (layers.whole.pixels) checkSize("The whole that layers are part of", layers.whole, frame.width, frame.height);
}

uint32_t layerImageCount(const NetworkConfig& config, const LayerSet& layers) {
  if (denoisesColours(config)) return 0;
  const bool hasAlbedo = config.auxOffset(kAlbedo.name) >= 0;
  return static_cast<uint32_t>(layers.lights.size() + layers.colours.size()) + 1 + (hasAlbedo ? 1 : 0);
}

LayerFrame::LayerFrame(const NetworkConfig& config, FrameShape frame, const LayerSet& layers, const PixelView& colour,
                       std::span<const PixelView> auxiliary)
    : config_(config), layers_(layers), guesses_(layers.lights.size() + 1), frame_(frame) {
  const size_t pixels = size_t{config.scale} * config.scale * frame.width * frame.height;
  for (const LightLayer& layer : layers.lights) filtered_.push_back(repaired(layer.light));
  mostLight_.resize(layers.colours.size());
  for (size_t i = 0; i < layers.colours.size(); ++i) {
    const Image pass = repaired(layers.colours[i].low);
    for (size_t p = 0; p < pass.pixels.size(); ++p) {
      double light = 0;
      for (size_t k = 0; k < layers.lights.size(); ++k) {
        if (layers.lights[k].colour != static_cast<int>(i)) continue;
        light += filtered_[k].pixels[p];
        filtered_[k].pixels[p] = std::min(filtered_[k].pixels[p] * pass.pixels[p], kMostLight);
      }
      mostLight_[i][p % 3] = std::max(mostLight_[i][p % 3], kMostGain * light);
    }
    filtered_.push_back(pass);
    const PixelView& full = layers.colours[i].full;
    fulls_.push_back(full.pixels ? passes_.emplace_back(full, PixelKind::radiance).view() : PixelView{});
  }
  makeRest(layers.whole.pixels ? layers.whole : colour);
  restMean_.resize(3 * pixels);
  if (const int first = config.auxOffset(kAlbedo.name); first >= 0) {
    albedo_ = auxiliary[static_cast<size_t>(first) / 3];
    albedoMean_.resize(3 * pixels);
    Image mean(static_cast<int>(frame.width), static_cast<int>(frame.height), 3);
    const float share = 1.F / static_cast<float>(config.scale * config.scale);
    for (uint32_t y = 0; y < albedo_.height; ++y)
      for (uint32_t x = 0; x < albedo_.width; ++x)
        for (uint32_t c = 0; c < 3; ++c)
          mean.pixels[3 * (size_t{y / config.scale} * frame.width + x / config.scale) + c] +=
              share * (std::clamp(pixelOf(albedo_, size_t{y} * albedo_.width + x)[c], 0.F, shader::kAlbedoMax) +
                       shader::kAlbedoEpsilon);
    filtered_.push_back(std::move(mean));
  }
  for (const LightLayer& layer : layers.lights) factors_.push_back(factorOf(layer));
  factors_.push_back(factorOf({}));
}

// What of the whole no layer has, and the means of the layers over the frame.
void LayerFrame::makeRest(const PixelView& whole) {
  const size_t lights = layers_.lights.size();
  Image rest = repaired(whole);
  const size_t pixels = rest.pixelCount();
  everywhere_.resize(lights + 1);
  double ofWhole = 0, ofLayers = 0, missing = 0;
  for (size_t i = 0; i < rest.pixels.size(); ++i) {
    double sum = 0;
    for (size_t k = 0; k < lights; ++k) {
      sum += filtered_[k].pixels[i];
      everywhere_[k][i % 3] += filtered_[k].pixels[i] / static_cast<double>(pixels);
    }
    const double all = rest.pixels[i], more = all - sum > denoising::kLayerRounding * all ? all - sum : 0;
    ofWhole += all;
    ofLayers += sum;
    missing += more;
    rest.pixels[i] = static_cast<float>(more);
    everywhere_[lights][i % 3] += more / static_cast<double>(pixels);
  }
  share_ = ofWhole > 0 ? ofLayers / ofWhole : 1;
  isBlack_ = !(ofWhole > 0);
  if (missing < denoising::kLeastMissingLight * ofWhole) {
    std::fill(rest.pixels.begin(), rest.pixels.end(), 0.F);
    everywhere_[lights] = {};
  }
  filtered_.push_back(std::move(rest));
}

std::vector<LayerImage> LayerFrame::images() {
  std::vector<std::span<float>> means;
  for (const LightLayer& layer : layers_.lights) means.push_back(layer.output);
  for (const LayerColour& pass : layers_.colours) means.push_back(pass.output);
  means.emplace_back(restMean_);
  if (albedo_.pixels) means.emplace_back(albedoMean_);
  std::vector<LayerImage> images;
  if (denoisesColours(config_)) {
    for (size_t i = 0; i < filtered_.size(); ++i)
      std::copy_n(filtered_[i].pixels.begin(), means[i].size(), means[i].begin());
    return images;
  }
  for (size_t i = 0; i < filtered_.size(); ++i)
    images.push_back({{filtered_[i].pixels.data(), frame_.width, frame_.height}, means[i]});
  return images;
}

LayerFrame::Factor LayerFrame::factorOf(const LightLayer& layer) const {
  if (layer.colour >= 0) {
    const auto place = static_cast<size_t>(layer.colour);
    return {layers_.colours[place].output.data(), fulls_[place]};
  }
  if (!layer.followsAlbedo || !albedo_.pixels) return {};
  return {albedoMean_.data(), albedo_, shader::kAlbedoEpsilon, shader::kAlbedoMax};
}

// What a light is at a pixel by its mean, if nothing but its colour has more detail.
double LayerFrame::guess(const Factor& factor, double light, size_t pixel, uint32_t c) const {
  if (!factor.mean || !factor.full.pixels || !(light > 0)) return light;
  const double mean = factor.mean[3 * pixel + c];
  if (!(mean > 0)) return 0;
  double own = finite(pixelOf(factor.full, pixel)[c]);
  if (factor.most > 0) own = std::min(own, factor.most);
  return light * ((own + factor.floor) / mean);
}

void LayerFrame::sharePixel(std::span<const float> picture, size_t pixel, LayerReport& report) {
  const size_t lights = layers_.lights.size();
  bool isUnshared = false;
  for (uint32_t c = 0; c < 3; ++c) {
    const size_t at = 3 * pixel + c;
    const double wanted = std::max(picture[at], 0.F);
    const auto light = [&](size_t k) {
      return std::max(0.0, double{k < lights ? layers_.lights[k].output[at] : restMean_[at]});
    };
    double sum = 0, lightSum = 0;
    for (size_t k = 0; k <= lights; ++k) {
      const double mean = light(k);
      lightSum += mean;
      sum += guesses_[k] = guess(factors_[k], mean, pixel, c);
    }
    // Where colours leave too little, their lights go in without them; where there is no light, that of everywhere.
    if (const double least = wanted / kMostGain; sum < least) {
      const double more = lightSum > 0 ? (least - sum) / lightSum : 0;
      sum = 0;
      for (size_t k = 0; k <= lights; ++k)
        sum += guesses_[k] = lightSum > 0 ? guesses_[k] + more * light(k) : everywhere_[k][c];
    }
    isUnshared |= wanted > 0 && !(sum > 0) && !isBlack_;
    for (size_t k = 0; k < lights; ++k)
      layers_.lights[k].output[at] = sum > 0 ? static_cast<float>(wanted * (guesses_[k] / sum)) : 0.F;
  }
  report.unshared += isUnshared;
}

// Divides the lights by their colours, which are raised where a light would exceed all that there is.
void LayerFrame::splitPixel(size_t pixel, LayerReport& report) {
  for (size_t i = 0; i < layers_.colours.size(); ++i) {
    const LayerColour& pass = layers_.colours[i];
    bool isRaised = false;
    for (uint32_t c = 0; c < 3; ++c) {
      const size_t at = 3 * pixel + c;
      double sum = 0;
      for (const LightLayer& layer : layers_.lights)
        if (layer.colour == static_cast<int>(i)) sum += layer.output[at];
      double own = finite(fulls_[i].pixels ? pixelOf(fulls_[i], pixel)[c] : pass.output[at]);
      if (sum > own * mostLight_[i][c]) {
        own = sum / mostLight_[i][c];
        isRaised = true;
      }
      pass.output[at] = static_cast<float>(own);
      for (const LightLayer& layer : layers_.lights)
        if (layer.colour == static_cast<int>(i))
          layer.output[at] = own > 0 ? std::min(static_cast<float>(layer.output[at] / own), kMostFloat) : 0.F;
    }
    report.raisedColours += isRaised;
  }
}

LayerReport LayerFrame::share(std::span<const float> picture) {
  LayerReport report{.share = share_};
  for (size_t pixel = 0; pixel < picture.size() / 3; ++pixel) {
    sharePixel(picture, pixel, report);
    splitPixel(pixel, report);
  }
  return report;
}

}  // namespace xrds
