#include "app/frame_layers.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <iterator>
#include <sstream>

#include "app/copied_layers.h"
#include "app/nearest.h"
#include "image/image_view.h"
#include "image/layers/aov_candidates.h"
#include "image/layers/light_names.h"
#include "image/repair.h"
#include "xrds/denoised_first.h"
#include "xrds/error.h"
#include "xrds/merged_colour.h"

namespace xrds {
namespace {

constexpr double kMost = 1.05;  // of the colour that layers may make up

bool isBlack(const Image& image) { return denoising::isBlack(image.pixels); }

// a b, or a / b, where b is not black.
Image combined(const Image& a, const Image& b, bool divides) {
  Image result = a;
  for (size_t i = 0; i < result.pixels.size(); ++i)
    result.pixels[i] = !divides ? a.pixels[i] * b.pixels[i] : b.pixels[i] > 0 ? a.pixels[i] / b.pixels[i] : 0.F;
  return result;
}

Image merged(const Image& low, const Image& full, double share) {
  Image result(low.width, low.height, 3);
  result.pixels = mergedColour(viewOf(low), viewOf(full), share);
  return result;
}

// By its own name, or by the name with all that stands before it.
const AovCandidate* findCandidate(const std::vector<AovCandidate>& candidates, const std::string& name,
                                  bool whole = false) {
  const auto found = std::find_if(candidates.begin(), candidates.end(), [&](const AovCandidate& candidate) {
    return (candidate.stem == name && !whole) || candidate.selection.layer == name;
  });
  return found == candidates.end() ? nullptr : &*found;
}

[[noreturn]] void throwMissing(const ExrFile& file, const std::vector<AovCandidate>& candidates,
                               const std::string& name) {
  std::vector<std::string> there;
  for (const AovCandidate& candidate : candidates) there.push_back(candidate.stem);
  const std::string meant = nearest(name, there);
  throw Error("The colour's render has no layer '" + printable(name) + "' of three channels beside its colour" +
              (meant.empty() ? "; " + describe(file) : ": did you mean '" + printable(meant) + "'?"));
}

// Layers of the size of a part, of the default view.
std::vector<AovCandidate> candidatesOf(const ExrFile& file, size_t part) {
  std::vector<AovCandidate> candidates = aovCandidates(file, AovRole::kColor);
  std::erase_if(candidates, [&](const AovCandidate& candidate) {
    return !candidate.view.empty() || file.parts[candidate.selection.part].dataWindow != file.parts[part].dataWindow;
  });
  return candidates;
}

// Those of a view layer, or all where the file has a single one, whatever its name.
std::vector<AovCandidate> ofViewLayer(std::vector<AovCandidate> candidates, const std::string& prefix) {
  const auto isOfAnother = [&](const AovCandidate& candidate) { return candidate.prefix != candidates.front().prefix; };
  if (std::any_of(candidates.begin(), candidates.end(), isOfAnother))
    std::erase_if(candidates, [&](const AovCandidate& candidate) { return candidate.prefix != prefix; });
  return candidates;
}

}  // namespace

LayerRequest layerRequest(const std::string& text) {
  if (text == "all") return {.all = true};
  LayerRequest request;
  std::istringstream list(text);
  for (std::string name; std::getline(list, name, ',');) {
    name.erase(0, std::min(name.find_first_not_of(' '), name.size()));
    name.erase(name.find_last_not_of(' ') + 1);
    if (!name.empty()) request.names.push_back(name);
  }
  return request;
}

FrameLayers::FrameLayers(const Files& files, const LayerRequest& request, std::optional<double> share) {
  find(files, request);
  read(files);
  makeRest(files);
  if (share) merge(files, *share);
  makeWhole();
  copyOthers(files);
}

void FrameLayers::copyOthers(const Files& files) {
  if (!files.fullPart) return;
  MadeLayers made{.channels = colourChannels_, .lights = unasked_};
  if (!alphaChannel_.empty()) made.channels.push_back(alphaChannel_);
  const auto add = [&](const std::vector<std::string>& channels, const std::optional<ExrSelection>& source) {
    made.channels.insert(made.channels.end(), channels.begin(), channels.end());
    if (source) made.sources.push_back(*source);
  };
  for (const Light& light : lights_) add(light.channels, light.full);
  for (const Colour& pass : colours_) add(pass.channels, pass.full);
  take(copyLayers(files.full, *files.fullPart, files.window, made));
  const size_t own = files.colourLayer.part;
  if (files.full.path == files.colour.path || files.colour.parts[own].dataWindow != files.window) return;
  // Of one size: what the other file lacks.
  for (const ExrPlane& plane : copied_) made.channels.push_back(plane.name);
  made.sources = {files.colourLayer};
  for (const Light& light : lights_) made.sources.push_back(light.low);
  for (const Colour& pass : colours_) made.sources.push_back(pass.low);
  take(copyLayers(files.colour, own, files.window, made));
}

void FrameLayers::take(CopiedLayers copied) {
  const auto append = [](auto& to, auto& from) { std::move(from.begin(), from.end(), std::back_inserter(to)); };
  append(copied_, copied.planes);
  append(attributes_, copied.attributes);
  append(list_.copied, copied.names);
  append(list_.leftOut, copied.leftOut);
}

void FrameLayers::find(const Files& files, const LayerRequest& request) {
  const auto all = candidatesOf(files.colour, files.colourLayer.part);
  const auto own = std::find_if(
      all.begin(), all.end(), [&](const AovCandidate& candidate) { return candidate.selection == files.colourLayer; });
  const std::string prefix = own == all.end() ? "" : own->prefix;
  std::vector<AovCandidate> low = all, full;
  std::erase_if(low, [&](const AovCandidate& candidate) { return candidate.prefix != prefix; });
  if (files.fullPart) full = ofViewLayer(candidatesOf(files.full, *files.fullPart), prefix);
  std::vector<std::string> names = request.names;
  for (const AovCandidate& candidate : low)
    if (isLight(candidate.stem)) (request.all ? names : unasked_).push_back(candidate.stem);
  for (const std::string& name : names) {
    const AovCandidate* found = findCandidate(low, name);
    if (!found) found = findCandidate(all, name, true);
    if (!found) throwMissing(files.colour, low, name);
    if (lightName(found->stem).kind != LightName::Kind::colour && found->selection != files.colourLayer)
      addLight(files, *found, low, full);
  }
  if (lights_.empty())
    throw Error(
        "No light layer is found beside the colour, such as DiffDir, Emit or Combined_key of Cycles: name those that "
        "are wanted, --layers NAME,NAME; " +
        describe(files.colour));
  colourChannels_ = outputNames(files.colour, files.colourLayer);
  if (files.alphaLayer) alphaChannel_ = outputNames(files.colour, *files.alphaLayer).front();
  if (own == all.end() || !namesNoisyRender(own->stem)) return;
  const std::string finished = (prefix.empty() ? "" : prefix + ".") + "Combined.";
  for (const size_t c : {0, 1, 2}) colourChannels_[c] = finished + "RGB"[c];  // the result is what Cycles calls so
  if (files.alphaLayer) alphaChannel_ = finished + "A";
}

void FrameLayers::addLight(const Files& files, const AovCandidate& found, const std::vector<AovCandidate>& low,
                           const std::vector<AovCandidate>& full) {
  const auto isFound = [&](const Light& light) { return light.low == found.selection; };
  if (std::any_of(lights_.begin(), lights_.end(), isFound)) return;  // it was named twice
  const auto inFull = [&](const std::string& name) -> std::optional<ExrSelection> {
    const AovCandidate* same = findCandidate(full, name);
    return same ? std::optional(same->selection) : std::nullopt;
  };
  const LightName known = lightName(found.stem);
  Light light{found.stem, outputNames(files.colour, found.selection), found.selection, inFull(found.stem)};
  light.followsAlbedo = known.followsAlbedo;
  light.isGroup = known.kind == LightName::Kind::group;
  if (const AovCandidate* pass = known.colour.empty() ? nullptr : findCandidate(low, known.colour)) {
    auto place = std::find_if(colours_.begin(), colours_.end(), [&](const Colour& c) { return c.name == pass->stem; });
    if (place == colours_.end())
      place = colours_.insert(
          place, {pass->stem, outputNames(files.colour, pass->selection), pass->selection, inFull(pass->stem)});
    light.colour = static_cast<int>(place - colours_.begin());
  }
  lights_.push_back(std::move(light));
}

Image FrameLayers::readRadiance(const ExrFile& file, const ExrSelection& layer) {
  Image image = readLayer(file, layer);
  repaired_.push_back({layer, repairRadiance(image)});
  return image;
}

Image FrameLayers::readFull(const ExrFile& file, const ExrSelection& layer, const Box& window) {
  Image image = placedInBox(readLayer(file, layer), file.parts[layer.part].dataWindow, window);
  repaired_.push_back({layer, repairRadiance(image)});
  return image;
}

void FrameLayers::read(const Files& files) {
  for (Light& light : lights_) {
    light.image = readRadiance(files.colour, light.low);
    list_.upscaled.push_back(printable(light.name));
  }
  for (Colour& pass : colours_) {
    pass.image = readRadiance(files.colour, pass.low);
    if (pass.full) pass.fullImage = readFull(files.full, *pass.full, files.window);
    const bool isUpscaled = files.window != files.colour.parts[files.colourLayer.part].dataWindow;
    list_.upscaled.push_back(printable(pass.name) + (!isUpscaled ? ""
                                                     : pass.full ? " (of full resolution)"
                                                                 : " (filtered)"));
  }
}

// What of the colour's render is in no layer: a light of its own unless it is rounding.
void FrameLayers::makeRest(const Files& files) {
  Image whole = readLayer(files.colour, files.colourLayer);  // what is repaired in it was told
  repairRadiance(whole);
  for (const bool groups : {false, true}) {
    denoising::RestOfLayers found = denoising::restOfLayers(whole.pixels, radiances(groups));
    Image& rest = rest_[groups ? 1 : 0];
    rest = whole;
    rest.pixels = std::move(found.pixels);
    if (hasLights(groups)) shares_.push_back(found.share);
  }
}

bool FrameLayers::hasLights(bool groups) const {
  return std::any_of(lights_.begin(), lights_.end(), [&](const Light& light) { return light.isGroup == groups; });
}

Image FrameLayers::radianceOf(const Light& light) const {
  return light.colour < 0 ? light.image
                          : combined(light.image, colours_[static_cast<size_t>(light.colour)].image, false);
}

std::vector<std::vector<float>> FrameLayers::radiances(bool groups) const {
  std::vector<std::vector<float>> found;
  for (const Light& light : lights_)
    if (light.isGroup == groups) found.push_back(radianceOf(light).pixels);
  return found;
}

// What each set adds up to, after whatever was done to its layers.
void FrameLayers::makeWhole() {
  for (const bool groups : {false, true}) {
    Image& whole = whole_[groups ? 1 : 0];
    whole = rest_[groups ? 1 : 0];
    whole.pixels = denoising::sumOfLayers(std::move(whole.pixels), radiances(groups));
  }
}

// All or none: sums of which a part is merged would not be those of the merged colour.
void FrameLayers::merge(const Files& files, double share) {
  const auto hasFull = [](const auto& layer) { return layer.full.has_value(); };
  if (!std::all_of(lights_.begin(), lights_.end(), hasFull) || !std::all_of(colours_.begin(), colours_.end(), hasFull))
    return;
  std::vector<Image> means;
  for (const Colour& pass : colours_) means.push_back(merged(pass.image, pass.fullImage, share));
  for (Light& light : lights_) {
    const Image full = readFull(files.full, *light.full, files.window);
    if (light.colour < 0) {
      light.image = merged(light.image, full, share);
      continue;
    }
    const auto place = static_cast<size_t>(light.colour);
    const Image radiance = merged(radianceOf(light), combined(full, colours_[place].fullImage, false), share);
    light.image = combined(radiance, means[place], true);
  }
  for (size_t i = 0; i < colours_.size(); ++i) colours_[i].image = std::move(means[i]);
  list_.merged = true;
}

void FrameLayers::denoise(ImageDenoiser& denoiser, const Image* albedo, const Image* normal, uint32_t passes) {
  const auto clean = [&](Image& image) {
    if (!isBlack(image)) image = denoiser.denoised(image, albedo, normal, passes);
  };
  for (Light& light : lights_) clean(light.image);
  for (Image& rest : rest_) clean(rest);
  makeWhole();
}

size_t FrameLayers::noisyImages() const {
  const auto lights = std::count_if(lights_.begin(), lights_.end(), [](const Light& l) { return !isBlack(l.image); });
  return static_cast<size_t>(lights + std::count_if(std::begin(rest_), std::end(rest_), std::not_fn(isBlack)));
}

void FrameLayers::denoiseColours(ImageDenoiser& denoiser) {
  for (Colour& pass : colours_) {
    pass.image = denoiser.denoisedAlbedo(pass.image);
    if (pass.full) pass.fullImage = pass.image;
  }
}

UpscaledLayers FrameLayers::room(int scale) const {
  UpscaledLayers room;
  for (const Light& light : lights_) room.lights.emplace_back(scale * light.image.width, scale * light.image.height, 3);
  for (const Colour& pass : colours_) room.colours.emplace_back(scale * pass.image.width, scale * pass.image.height, 3);
  return room;
}

std::vector<LayerSet> FrameLayers::sets(UpscaledLayers& to) const {
  std::vector<LayerSet> sets;
  for (const bool groups : {false, true}) {
    LayerSet set{.whole = viewOf(whole_[groups ? 1 : 0])};
    for (size_t i = 0; i < lights_.size(); ++i)
      if (const Light& light = lights_[i]; light.isGroup == groups)
        set.lights.push_back({viewOf(light.image), to.lights[i].pixels, light.colour, light.followsAlbedo});
    if (set.lights.empty()) continue;
    for (size_t i = 0; i < colours_.size() && !groups; ++i) {
      const Colour& pass = colours_[i];
      set.colours.push_back(
          {viewOf(pass.image), pass.full ? viewOf(pass.fullImage) : PixelView{}, to.colours[i].pixels});
    }
    sets.push_back(std::move(set));
  }
  return sets;
}

std::vector<LayerReport> FrameLayers::reports(std::vector<LayerReport> found) const {
  for (size_t set = 0; set < found.size(); ++set) found[set].share = shares_.at(set);
  return found;
}

std::vector<ExrPlane> FrameLayers::planes(const Image& colour, const UpscaledLayers& upscaled,
                                          ExrPixelType type) const {
  std::vector<ExrPlane> all = copied_;
  const auto add = [&](const Image& image, const std::vector<std::string>& names) {
    std::vector<ExrPlane> planes = planesOf(image, names, type);
    std::move(planes.begin(), planes.end(), std::back_inserter(all));
  };
  std::vector<std::string> names = colourChannels_;
  if (colour.channels == 4) names.push_back(alphaChannel_);
  add(colour, names);
  for (size_t i = 0; i < lights_.size(); ++i) add(upscaled.lights[i], lights_[i].channels);
  for (size_t i = 0; i < colours_.size(); ++i) add(upscaled.colours[i], colours_[i].channels);
  return all;
}

std::vector<std::string> FrameLayers::warnings(const UpscaledLayers& upscaled) const {
  std::vector<std::string> warnings;
  char text[200];
  for (const LayerReport& report : upscaled.reports) {
    if (report.share > kMost || report.share < 1 - denoising::kLeastMissingLight) {
      std::snprintf(text, sizeof text, "the layers add up to %.1f %% of the colour, %s.", 100 * report.share,
                    report.share > 1 ? "and each gets its share of it: leave out what is the sum of others"
                                     : "and of the result");
      warnings.emplace_back(text);
    }
    if (report.unshared > 0)
      warnings.push_back(std::to_string(report.unshared) + " pixels have light in a channel that no layer has.");
  }
  return warnings;
}

}  // namespace xrds
