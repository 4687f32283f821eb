#include "app/frame.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "app/listed.h"
#include "app/models.h"
#include "image/aux_check.h"
#include "image/edge_check.h"
#include "image/repair.h"
#include "image/shift_check.h"
#include "xrds/denoised_first.h"

namespace xrds {
namespace {

std::string nameOf(const ExrSelection& layer) { return printable(layer.layer); }

constexpr const char *kFilled = "not finite, filled from the neighbours", *kNegative = "negative, set to 0";

bool covers(const Box& outer, const Box& inner) {
  return outer.minX <= inner.minX && outer.minY <= inner.minY && outer.maxX >= inner.maxX && outer.maxY >= inner.maxY;
}

bool overlap(const Box& a, const Box& b) {
  return a.minX <= b.maxX && b.minX <= a.maxX && a.minY <= b.maxY && b.minY <= a.maxY;
}

}  // namespace

Frame::Frame(const std::filesystem::path& colorPath, const std::filesystem::path& auxPath, const AovRequest& request,
             const std::vector<std::string>& auxiliaryInputs, const MergeRequest& merge)
    : colorFile_(readExrHeader(colorPath)),
      inputs_(auxiliaryInputs),
      merge_(merge),
      fullColourName_(request.nameOf(AovRole::kFullColor)) {
  const bool mergesAlone = inputs_.empty() && merge_.ofAllModels && !merge_.never;
  const bool twoFiles = !auxPath.empty() && (!inputs_.empty() || mergesAlone);
  auxFile_ = twoFiles ? readExrHeader(auxPath) : colorFile_;
  AovRequest needed = request;
  needed.needed.clear();
  for (const std::string& input : inputs_) needed.needed.push_back(roleOf(input));
  aovs_ = findAovs(colorFile_, auxFile_, needed);
  warnings_ = aovs_.notes;
  for (const std::string& input : inputs_) fit(input);
  if (mergesAlone) fitFullColour();
  if (!auxPath.empty() && !fit_) {
    warnings_.push_back("The model takes no auxiliary images; '" + auxPath.string() + "' is not used.");
    auxFile_ = colorFile_;
  }
}

// Without other images that tell the size the full-resolution colour does, where there is one.
void Frame::fitFullColour() {
  if (!mayHaveFullColour()) return;
  try {
    const FrameFit found = fitFrame(colourPart(), auxFile_.parts[findFullColour().part]);
    if (found.scale > 1) fit_ = found;
  } catch (const Error&) {
    if (isFullColourNamed()) throw;
  }
}

const ExrSelection& Frame::layerOf(std::string_view input) const { return aovs_.auxiliary.at(roleOf(input)); }

FrameLayer Frame::fullColourLayer() const {
  const ExrSelection& layer = layerOf(kFullColour.name);
  return {auxFile_.parts[layer.part], layer.layer};
}

std::optional<double> Frame::lowSamples() const {
  return merge_.samples ? merge_.samples->low : samplesOf(colourLayer());
}

void Frame::fit(const std::string& input) {
  const FrameFit found = fitFrame(colourPart(), auxFile_.parts[layerOf(input).part]);
  if (fit_ && found.scale != fit_->scale)
    throw Error("The " + inputs_.front() + " layer has " + std::to_string(fit_->scale) +
                " times the colour's size, the " + input + " layer " + std::to_string(found.scale) +
                " times: choose layers of one size with " + optionName(roleOf(inputs_.front())) + " and " +
                optionName(roleOf(input)) + ".");
  fit_ = found;
}

ExrOutput Frame::output(int scale) const {
  ExrOutput output = scaledOutput(colourPart(), scale);
  if (layers_) output.layerAttributes = layers_->attributes();
  if (fit_) output.displayWindow = fit_->displayWindow;
  return output;
}

void Frame::addRepaired(size_t count, const ExrSelection& layer, const char* what) {
  repairedPixels_ += count;
  if (count > 0) warnings_.push_back(counted(count, "pixel") + " of layer '" + nameOf(layer) + "' " + what + ".");
}

void Frame::load() {
  colour_ = readLayer(colorFile_, aovs_.color);
  const RepairCounts repaired = repairRadiance(colour_);
  if (repaired.nonFinitePixels == colour_.pixelCount())
    throw Error("No pixel of the colour '" + nameOf(aovs_.color) + "' in '" + colorFile_.path.string() +
                "' is finite; render it again.");
  addRepaired(repaired.nonFinitePixels, aovs_.color, kFilled);
  addRepaired(repaired.negativePixels, aovs_.color, kNegative);
  if (aovs_.alpha) {
    alpha_ = readLayer(colorFile_, *aovs_.alpha);
    addRepaired(repairNonFinite(*alpha_).nonFinitePixels, *aovs_.alpha,
                "with an alpha that is not finite, filled from the neighbours");
  }
  for (const std::string& input : inputs_) auxiliary_.push_back(loadAuxiliary(input));
  if (const Image* albedo = imageOf(kAlbedo.name))
    addWarnings(checkAlbedo({nameOf(layerOf(kAlbedo.name)), albedo}, imageOf(kNormal.name)));
  std::vector<NamedLayer> layers;
  for (size_t i = 0; i < inputs_.size(); ++i)
    if (const AuxiliaryInput& kind = *findAuxiliaryInput(inputs_[i]); !kind.isDistance && !kind.isRadiance)
      layers.push_back({inputs_[i], &auxiliary_[i]});
  if (!layers.empty()) addWarnings(checkEdges(colour_, layers));
  mergeColour();
}

// So one must be there.
bool Frame::isFullColourNamed() const { return !fullColourName_.empty() || merge_.samples; }

bool Frame::mayHaveFullColour() const { return isFullColourNamed() || hasAov(auxFile_, AovRole::kFullColor); }

// Where several could be meant and none is named, that of the colour's name: of its view layer.
ExrSelection Frame::findFullColour() const {
  try {
    return findAov(auxFile_, AovRole::kFullColor, fullColourName_, aovs_.place);
  } catch (const Error& error) {
    if (merge_.samples && fullColourName_.empty() && !hasAov(auxFile_, AovRole::kFullColor))
      throw Error(std::string(error.what()) +
                  "\n--samples LOW,HIGH asks for it: where there is none, --aux-colour never goes with it.");
    if (isFullColourNamed()) throw;
    return findAov(auxFile_, AovRole::kFullColor, aovs_.color.layer);
  }
}

// The colour of the render that the auxiliary images are of; a named one must be there.
std::optional<ExrSelection> Frame::fullColour() {
  if (merge_.never || !fit_ || fit_->scale < 2) return {};
  if (!mayHaveFullColour()) return {};
  try {
    ExrSelection found = findFullColour();
    const ExrPart& part = auxFile_.parts[found.part];
    const bool fits = fitFrame(colourPart(), part).scale == fit_->scale;
    if (fits && covers(part.dataWindow, scaledBox(colourPart().dataWindow, fit_->scale))) return found;
    const std::string what =
        "Layer '" + nameOf(found) + "' does not cover the frame at the size of the auxiliary images";
    if (isFullColourNamed()) throw Error(what + ".");
    if (fits) warnings_.push_back(what + ", and is not merged into the colour.");
  } catch (const Error&) {
    if (isFullColourNamed()) throw;
  }
  return {};
}

void Frame::mergeColour() {
  const std::optional<ExrSelection> layer = fullColour();
  if (!layer) return;
  const Image* input = imageOf(kFullColour.name);
  const Image full = input ? *input : loadRadiance(*layer);
  const double difference = colourDifference(viewOf(colour_), viewOf(full));
  if (!merge_.samples && difference > kMostColourDifference) {
    warnings_.push_back("The colour '" + nameOf(*layer) + "' of '" + auxFile_.path.string() +
                        "' differs from the frame's by " + std::to_string(std::lround(100 * difference)) +
                        " %: it is of other light, and is not used; --samples LOW,HIGH uses it.");
    return;
  }
  addWarnings(checkShift(colour_, {nameOf(*layer), &full}));
  chooseShare(*layer, full);
  colour_.pixels = mergedColour(viewOf(colour_), viewOf(full), merged_->share);
  colour_.channels = 3;
}

void Frame::chooseShare(const ExrSelection& layer, const Image& full) {
  const auto scale = static_cast<uint32_t>(fit_->scale);
  merged_ = MergedColour{nameOf(layer), 0, merge_.samples, "given"};
  if (!merged_->samples) {
    merged_->source = "metadata";
    merged_->samples = samplesOf(colourLayer(), {auxFile_.parts[layer.part], layer.layer});
  }
  if (merged_->samples) {
    merged_->share = fullShare(*merged_->samples, scale);
    return;
  }
  merged_->source = "noise";
  merged_->share = estimatedFullShare(viewOf(colour_), viewOf(full));
}

void Frame::loadLayers(const LayerRequest& request, uint32_t scale) {
  if (!aovs_.place.view.empty())
    throw Error("Layers are those of the default view of '" + colorFile_.path.string() + "', but the colour '" +
                nameOf(aovs_.color) + "' is of view '" + printable(aovs_.place.view) +
                "': store each view in a file of its own, or leave the layers out.");
  FrameLayers::Files files{
      colorFile_, auxFile_, aovs_.color, aovs_.alpha ? &*aovs_.alpha : nullptr, {}, colourPart().dataWindow};
  if (fit_) {
    files.fullPart = inputs_.empty() ? findFullColour().part : layerOf(inputs_.front()).part;
    files.window = scaledBox(colourPart().dataWindow, fit_->scale);
  } else if (scale == 1) {
    files.fullPart = aovs_.color.part;
  }
  layers_.emplace(files, request, merged_ ? std::optional(merged_->share) : std::nullopt);
  for (const auto& [layer, counts] : layers_->repaired()) {
    addRepaired(counts.nonFinitePixels, layer, kFilled);
    addRepaired(counts.negativePixels, layer, kNegative);
  }
}

void Frame::denoise(ImageDenoiser& denoiser, bool cleanGuides, uint32_t passes) {
  Image *albedo = imageOf(kAlbedo.name), *normal = imageOf(kNormal.name), *full = imageOf(kFullColour.name);
  if (passes > 1 && full && !layers_) noisy_ = Noisy{colour_, auxiliary_};
  if (albedo && !cleanGuides) *albedo = denoiser.denoisedAlbedo(*albedo);
  if (normal && !cleanGuides) *normal = denoiser.denoisedNormal(*normal);
  level();
  if (full) *full = denoiser.denoised(*full, albedo, normal, passes);
  for (size_t i = 0; i < inputs_.size(); ++i)
    if (findAuxiliaryInput(inputs_[i])->isRadiance && &auxiliary_[i] != full)
      auxiliary_[i] = denoiser.denoised(auxiliary_[i], albedo, normal, passes);
  const auto mean = [&](const Image& image) {
    return Image(colour_.width, colour_.height, 3, denoising::boxMean(viewOf(image), static_cast<uint32_t>(scale())));
  };
  std::optional<Image> lowAlbedo, lowNormal;
  if (albedo) lowAlbedo = mean(*albedo);
  if (normal) lowNormal = mean(*normal);
  colour_ = denoiser.denoised(colour_, lowAlbedo ? &*lowAlbedo : nullptr, lowNormal ? &*lowNormal : nullptr, passes);
  if (layers_) layers_->denoise(denoiser, lowAlbedo ? &*lowAlbedo : nullptr, lowNormal ? &*lowNormal : nullptr, passes);
  denoisedBy_ = denoiser.name();
}

void Frame::levelFor(const std::string& denoisers) {
  level();
  denoisedBy_ = denoisers;
}

// The full-resolution colour, if there is one, to the merged one.
void Frame::level() {
  Image* const full = imageOf(kFullColour.name);
  if (full && merged_) full->pixels = levelledColour(viewOf(*full), viewOf(colour_));
}

const Image* Frame::imageOf(std::string_view input) const { return xrds::imageOf(inputs_, auxiliary_, input); }

Image* Frame::imageOf(std::string_view input) { return const_cast<Image*>(std::as_const(*this).imageOf(input)); }

void Frame::replace(TemporalFilter::Merged merged) {
  colour_.channels = 3;
  colour_.pixels = std::move(merged.colour);
  if (Image* image = imageOf(kFullColour.name)) image->pixels = std::move(merged.fullColour);
  if (Image* image = imageOf(kAlbedo.name)) image->pixels = std::move(merged.albedo);
  if (Image* image = imageOf(kNormal.name)) image->pixels = std::move(merged.normal);
}

void Frame::addWarnings(const std::vector<std::string>& more) {
  warnings_.insert(warnings_.end(), more.begin(), more.end());
}

// A layer of the auxiliary file in the frame's window.
Image Frame::readFull(const ExrSelection& layer) const {
  return placedInBox(readLayer(auxFile_, layer), auxFile_.parts[layer.part].dataWindow,
                     scaledBox(colourPart().dataWindow, std::max(scale(), 1)));
}

Image Frame::loadRadiance(const ExrSelection& layer) const {
  Image image = readFull(layer);
  repairRadiance(image);
  return image;
}

// Of the lights, which Cycles splits, the sum of direct and indirect.
Image Frame::loadLight(AovRole role, const ExrSelection& layer) const {
  Image image = loadRadiance(layer);
  if (const auto indirect = indirectLight(auxFile_, role, layer)) {
    const Image more = loadRadiance(*indirect);
    std::transform(image.pixels.begin(), image.pixels.end(), more.pixels.begin(), image.pixels.begin(), std::plus<>());
  }
  return image;
}

Image Frame::loadAuxiliary(const std::string& input) {
  const ExrSelection& layer = layerOf(input);
  const Box& stored = auxFile_.parts[layer.part].dataWindow;
  const Box wanted = scaledBox(colourPart().dataWindow, fit_->scale);
  if (!overlap(stored, wanted))
    throw Error("No pixel of layer '" + nameOf(layer) + "' lies in the frame: expected some of " + toString(wanted) +
                ", found " + toString(stored) + "; render both from one camera, with the same origin of the windows.");
  if (!covers(stored, wanted))
    warnings_.push_back("Layer '" + nameOf(layer) + "' covers " + toString(stored) + " of the frame's " +
                        toString(wanted) + "; the rest is taken as 0.");
  const AuxiliaryInput& kind = *findAuxiliaryInput(input);
  if (kind.isRadiance) return loadLight(roleOf(input), layer);
  Image image = readFull(layer);
  if (!kind.isDistance) addRepaired(repairNonFinite(image).nonFinitePixels, layer, kFilled);
  if (kind.isDirection) addWarnings(checkNormal({nameOf(layer), &image}));
  if (kind.isDistance) {
    addWarnings(checkDepth({nameOf(layer), &image}));
    image.channels = 3;
    image.pixels = relativeDepth(image.pixels);
  }
  return image;
}

bool hasFullColour(const std::filesystem::path& colourPath, const std::filesystem::path& auxPath,
                   const AovRequest& layers) {
  try {
    const std::vector<std::string> inputs{std::string(kAlbedo.name), std::string(kFullColour.name)};
    return Frame(colourPath, auxPath, layers, inputs).scale() > 1;
  } catch (const Error&) {
    return false;
  }
}

const Image* imageOf(const std::vector<std::string>& inputs, const std::vector<Image>& images, std::string_view input) {
  const auto found = std::find(inputs.begin(), inputs.end(), input);
  return found == inputs.end() ? nullptr : &images.at(static_cast<size_t>(found - inputs.begin()));
}

std::vector<PixelView> inputsOf(const Model& model, const std::vector<std::string>& inputs,
                                const std::vector<Image>& images) {
  std::vector<PixelView> views;
  for (const std::string& input : model.auxiliaryInputs()) {
    const Image* image = imageOf(inputs, images, input);
    if (!image) throw Error("The model takes the image '" + input + "', which is not there.");
    views.push_back(viewOf(*image));
  }
  return views;
}

std::vector<PixelView> inputsOf(const Model& model, const Frame& frame) {
  if (!frame.merged() && takes(model, kFullColour))
    throw Error(std::string("The model takes the colour of the full-resolution render, which is not merged into the "
                            "colour here: ") +
                (frame.neverMerges() ? "leave out --aux-colour never" : "give --samples LOW,HIGH") +
                ", or take a model of albedo and normal.");
  return inputsOf(model, frame.inputs(), frame.auxiliary());
}

}  // namespace xrds
