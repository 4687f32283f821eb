#include "cli/frame.h"

#include <algorithm>

#include "image/aux_check.h"
#include "image/edge_check.h"
#include "image/repair.h"

namespace xrds {
namespace {

bool contains(const std::vector<std::string>& names, const char* name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

const ExrPart& partOf(const ExrFile& file, const ExrSelection& layer) { return file.parts[layer.part]; }

std::string counted(size_t count, const char* what, const std::string& layer) {
  return std::to_string(count) + (count == 1 ? " pixel" : " pixels") + " of layer '" + layer + "' " + what + ".";
}

std::string nameOf(const ExrSelection& layer) { return layer.layer.empty() ? "RGB" : layer.layer; }

}  // namespace

Frame::Frame(const std::filesystem::path& colorPath, const std::filesystem::path& auxPath, const AovRequest& request,
             const std::vector<std::string>& auxiliaryInputs)
    : colorFile_(readExrHeader(colorPath)),
      auxFile_(auxPath.empty() ? colorFile_ : readExrHeader(auxPath)),
      inputs_(auxiliaryInputs) {
  for (const std::string& input : inputs_)
    if (input != "albedo" && input != "normal")
      throw Error("The model needs the auxiliary image '" + input + "', which this program cannot find in an EXR file.");
  AovRequest needed = request;
  needed.albedoNeeded = contains(inputs_, "albedo");
  needed.normalNeeded = contains(inputs_, "normal");
  aovs_ = findAovs(colorFile_, auxFile_, needed);
  warnings_ = aovs_.notes;
  window_ = colorPart().dataWindow;
  for (const auto& layer : {aovs_.albedo, aovs_.normal}) {
    if (!layer) continue;
    const int found = scaleBetween(colorPart().displayWindow, partOf(auxFile_, *layer).displayWindow);
    if (scale_ != 0 && found != scale_) throw Error("The albedo and the normal layer have different sizes.");
    scale_ = found;
  }
}

void Frame::load() {
  colour_ = readLayer(colorFile_, aovs_.color);
  const RepairCounts repaired = repairRadiance(colour_);
  const std::string name = nameOf(aovs_.color);
  if (repaired.nonFinitePixels > 0)
    warnings_.push_back(counted(repaired.nonFinitePixels, "were not finite and were filled from their neighbours", name));
  if (repaired.negativePixels > 0) warnings_.push_back(counted(repaired.negativePixels, "had negative radiance, set to 0", name));
  if (aovs_.alpha) {
    alpha_ = readLayer(colorFile_, *aovs_.alpha);
    repairNonFinite(*alpha_);
  }
  for (const std::string& input : inputs_) auxiliary_.push_back(loadAuxiliary(input));
  std::vector<NamedLayer> layers;
  for (size_t i = 0; i < inputs_.size(); ++i) layers.push_back({inputs_[i], &auxiliary_[i]});
  const auto edges = checkEdges(colour_, layers);
  warnings_.insert(warnings_.end(), edges.begin(), edges.end());
}

Image Frame::loadAuxiliary(const std::string& input) {
  const bool albedo = input == "albedo";
  const ExrSelection& layer = albedo ? *aovs_.albedo : *aovs_.normal;
  Image image = placedInWindow(readLayer(auxFile_, layer), partOf(auxFile_, layer).dataWindow, scaledWindow(window_, scale_));
  const RepairCounts repaired = repairNonFinite(image);
  if (repaired.nonFinitePixels > 0)
    warnings_.push_back(counted(repaired.nonFinitePixels, "were not finite and were filled from their neighbours", layer.layer));
  const auto suspicions = albedo ? checkAlbedo({nameOf(layer), &image}) : checkNormal({nameOf(layer), &image});
  warnings_.insert(warnings_.end(), suspicions.begin(), suspicions.end());
  return image;
}

PixelView viewOf(const Image& image) {
  return {image.pixels.data(), static_cast<uint32_t>(image.width), static_cast<uint32_t>(image.height),
          static_cast<uint32_t>(image.channels)};
}

std::vector<PixelView> viewsOf(const std::vector<Image>& images) {
  std::vector<PixelView> views;
  for (const Image& image : images) views.push_back(viewOf(image));
  return views;
}

int findScale(const std::filesystem::path& colorPath, const std::filesystem::path& auxPath, AovRequest request) {
  return Frame(colorPath, auxPath, request, {"albedo"}).scale();
}

}  // namespace xrds
