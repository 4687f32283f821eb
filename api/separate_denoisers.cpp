#include "api/separate_denoisers.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "api/finite_image.h"
#include "image/repair.h"
#include "xrds/auxiliary_input.h"
#include "xrds/denoised_first.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint64_t kShareOfMemory = 4;  // one in so many bytes

bool isRadiance(const std::string& input) { return findAuxiliaryInput(input)->isRadiance; }

std::vector<float> finiteRadiance(const PixelView& view) {
  Image image = imageOf(view);
  repairRadiance(image);
  return std::move(image.pixels);
}

/// A set of layers as it is denoised.
struct Layers {
  Layers(const LayerSet& set, const PixelView& colour) {
    for (const LightLayer& layer : set.lights) lights.push_back(finiteRadiance(layer.light));
    for (const LayerColour& pass : set.colours) passes.push_back(finiteRadiance(pass.low));
    const std::vector<float> whole = finiteRadiance(set.whole.pixels ? set.whole : colour);
    rest = denoising::restOfLayers(whole, radiances(set));
  }
  std::vector<std::vector<float>> radiances(const LayerSet& set) const {
    std::vector<std::vector<float>> found = lights;
    for (size_t k = 0; k < lights.size(); ++k)
      if (const int pass = set.lights[k].colour; pass >= 0)
        std::transform(lights[k].begin(), lights[k].end(), passes[static_cast<size_t>(pass)].begin(), found[k].begin(),
                       std::multiplies<>());
    return found;
  }
  std::vector<std::vector<float>> lights, passes;
  denoising::RestOfLayers rest;
};

}  // namespace

Upscaler::Progress partOf(const Upscaler::Progress& progress, double begin, double share) {
  if (!progress) return {};
  return [&progress, begin, share](double done) { return progress(begin + share * done); };
}

/// One that is ready for images of a size.
struct SeparateDenoisers::Network {
  const NetworkModel& model;
  const FrameShape shape;
  FrameUpscaler upscaler;
};

SeparateDenoisers::SeparateDenoisers(Gpu& gpu, const NetworkConfig& upscaler, const DenoisingModels& models,
                                     const Upscaler::Options& options)
    : gpu_(gpu), upscaler_(upscaler), models_(models), options_(options) {}
SeparateDenoisers::~SeparateDenoisers() = default;

void SeparateDenoisers::release() { networks_.clear(); }

uint64_t SeparateDenoisers::byteSize() const {
  uint64_t sum = 0;
  for (const auto& network : networks_) sum += network->upscaler.deviceBytes();
  return sum;
}

uint32_t SeparateDenoisers::runs(const FrameImages& frame) const {
  const auto takes = [&](const AuxiliaryInput& input) { return upscaler_.auxOffset(input.name) >= 0; };
  uint32_t radiances = 1;
  for (const std::string& input : upscaler_.auxInputs) radiances += isRadiance(input);
  for (const LayerSet& set : frame.layers) radiances += static_cast<uint32_t>(set.lights.size()) + 1;
  return (models_.albedo && takes(kAlbedo)) + (models_.normal && takes(kNormal)) + options_.ensemble * radiances;
}

// Made ready where it is not.
FrameUpscaler& SeparateDenoisers::network(const NetworkModel& model, FrameShape shape) {
  const auto isThis = [&](const std::unique_ptr<Network>& network) {
    return &network->model == &model && network->shape.width == shape.width && network->shape.height == shape.height;
  };
  const auto found = std::find_if(networks_.begin(), networks_.end(), isThis);
  if (found != networks_.end()) return (*found)->upscaler;
  if (options_.tiles.memoryBytes || byteSize() > gpu_.description().memoryBytes / kShareOfMemory) networks_.clear();
  Upscaler::Options asked{.fp16 = options_.fp16,
                          .profile = options_.profile,
                          .tiles = {.memoryBytes = options_.tiles.memoryBytes, .exact = true},
                          .multiplyAddsPerSubmission = options_.multiplyAddsPerSubmission,
                          .tune = Upscaler::Tune::never};
  networks_.push_back(std::unique_ptr<Network>(new Network{model, shape, FrameUpscaler(gpu_, model, shape, asked)}));
  return networks_.back()->upscaler;
}

SeparateDenoisers::Pixels SeparateDenoisers::ran(const NetworkModel& model, const PixelView& image,
                                                 std::span<const PixelView> guides) {
  FrameUpscaler& upscaler = network(model, {image.height, image.width});
  Pixels result(size_t{3} * image.width * image.height);
  const auto hear = [&](double share) {
    heard_ = std::max(heard_, (done_ + share) / runs_);  // one that runs again begins anew
    return hear_(heard_);
  };
  if (!upscaler.run(image, guides, result, {}, hear_ ? Upscaler::Progress(hear) : Upscaler::Progress()))
    throw Stopped{};
  ++done_;
  const auto rows = upscaler.profile();
  rows_.insert(rows_.end(), rows.begin(), rows.end());
  return result;
}

// Where the device has no room for it, the other networks go first, then what else is there.
SeparateDenoisers::Pixels SeparateDenoisers::through(const NetworkModel& model, const PixelView& image,
                                                     std::span<const PixelView> guides) {
  try {
    return ran(model, image, guides);
  } catch (const OutOfMemory&) {
    networks_.clear();
  }
  try {
    return ran(model, image, guides);
  } catch (const OutOfMemory&) {
    networks_.clear();
    makeRoom_();
  }
  return ran(model, image, guides);
}

SeparateDenoisers::Pixels SeparateDenoisers::radiance(const PixelView& image, std::span<const PixelView> guides) {
  return denoising::denoisedRadiance(image, guides, options_.ensemble,
                                     [&](const PixelView& turned, std::span<const PixelView> turnedGuides) {
                                       return through(*models_.colour, turned, turnedGuides);
                                     });
}

PixelView SeparateDenoisers::kept(Pixels pixels, const PixelView& like) {
  return denoising::viewOf(pixels_.emplace_back(std::move(pixels)), like.width, like.height);
}

// Of the images those that the network of the colour takes.
std::vector<PixelView> SeparateDenoisers::guidesOf(const std::vector<PixelView>& auxiliary) const {
  std::vector<PixelView> guides;
  for (const std::string& guide : models_.colour->config().auxInputs) {
    const auto& inputs = upscaler_.auxInputs;
    guides.push_back(auxiliary[static_cast<size_t>(std::find(inputs.begin(), inputs.end(), guide) - inputs.begin())]);
  }
  return guides;
}

void SeparateDenoisers::denoiseGuides(std::vector<PixelView>& auxiliary) {
  const auto& inputs = upscaler_.auxInputs;
  for (size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i] == kAlbedo.name && models_.albedo)
      auxiliary[i] =
          kept(denoising::denoisedAlbedo(auxiliary[i],
                                         [&](const PixelView& image) { return through(*models_.albedo, image, {}); }),
               auxiliary[i]);
    if (inputs[i] == kNormal.name && models_.normal)
      auxiliary[i] = kept(through(*models_.normal, auxiliary[i], {}), auxiliary[i]);
  }
}

void SeparateDenoisers::denoiseLayers(FrameImages& frame, size_t place, const PixelView& colour,
                                      std::span<const PixelView> guides) {
  LayerSet& set = frame.layers[place];
  Layers layers(set, colour);
  frame.shares.push_back(layers.rest.share);
  const auto clean = [&](Pixels& pixels) {
    if (!denoising::isBlack(pixels))
      pixels = radiance(denoising::viewOf(pixels, colour.width, colour.height), guides);
    else
      done_ += options_.ensemble;
  };
  for (Pixels& light : layers.lights) clean(light);
  clean(layers.rest.pixels);
  set.whole = kept(denoising::sumOfLayers(std::move(layers.rest.pixels), layers.radiances(set)), colour);
  for (size_t k = 0; k < set.lights.size(); ++k) set.lights[k].light = kept(std::move(layers.lights[k]), colour);
}

void SeparateDenoisers::denoise(FrameImages& frame) {
  const PixelView given = frame.colour;
  denoiseGuides(frame.auxiliary);
  const std::vector<PixelView> guides = guidesOf(frame.auxiliary);
  for (size_t i = 0; i < frame.auxiliary.size(); ++i)
    if (isRadiance(upscaler_.auxInputs[i]))
      frame.auxiliary[i] =
          kept(radiance(kept(finiteRadiance(frame.auxiliary[i]), frame.auxiliary[i]), guides), frame.auxiliary[i]);
  std::vector<PixelView> means;
  for (const PixelView& guide : guides) means.push_back(kept(denoising::boxMean(guide, upscaler_.scale), given));
  const PixelView noisy = kept(finiteRadiance(given), given);
  frame.colour = kept(radiance(noisy, means), noisy);
  for (size_t i = 0; i < frame.layers.size(); ++i) denoiseLayers(frame, i, noisy, means);
}

std::optional<FrameImages> SeparateDenoisers::denoised(const FrameImages& frame,
                                                       const std::function<bool(double)>& hear,
                                                       const std::function<void()>& makeRoom) {
  hear_ = hear;
  makeRoom_ = makeRoom;
  heard_ = 0;
  done_ = 0;
  rows_.clear();
  runs_ = runs(frame);
  pixels_.clear();
  FrameImages clean = frame;
  try {
    denoise(clean);
  } catch (const Stopped&) {
    return {};
  } catch (...) {
    release();
    throw;
  }
  profile_.swap(rows_);
  return clean;
}

}  // namespace xrds
