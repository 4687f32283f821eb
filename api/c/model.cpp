#include <cstring>

#include "api/c/handles.h"
#include "api/c/images.h"
#include "api/c/result.h"
#include "xrds/auxiliary_input.h"
#include "xrds/shipped_models.h"

using namespace xrds::c;

namespace {

// A name without a folder or an ending is a shipped model's.
std::filesystem::path fileOf(const std::string& nameOrFile) {
  if (nameOrFile.ends_with(".safetensors") || std::filesystem::path(nameOrFile).has_parent_path()) return nameOrFile;
  std::filesystem::path file = xrds::findModel(nameOrFile);
  if (!file.empty()) return file;
  std::string folders;
  for (const auto& folder : xrds::modelFolders()) folders += (folders.empty() ? "'" : " or '") + folder.string() + "'";
  throw xrds::Error("There is no model '" + nameOrFile + "' in " + folders +
                    ": give a .safetensors file, or set XRDS_MODELS to the folder of the models.");
}

void copyText(const std::string& text, char* to, const char* argument, size_t capacity) {
  if (text.size() >= capacity)
    throw xrds::InvalidArgument("A text of " + std::to_string(text.size()) + " characters has no room in " +
                                std::to_string(capacity) + " for '" + argument + "'.");
  std::memcpy(&required(to, argument), text.c_str(), text.size() + 1);
}

// As the command chooses; an unknown image has no say.
std::string chosenModel(uint32_t scale, const std::vector<std::string_view>& inputs, double samples) {
  constexpr uint32_t kScaleOfColourAlone = 4;
  const uint32_t known = inputs.empty() ? kScaleOfColourAlone : scale;
  std::string name = xrds::variantName(known, inputs, samples > 0 ? std::optional(samples) : std::nullopt);
  if (!xrds::findModel(name).empty()) return name;
  constexpr std::string_view kBoth[] = {xrds::kAlbedo.name, xrds::kNormal.name};
  if (name = inputs.empty() ? name : xrds::variantName(known, kBoth); !xrds::findModel(name).empty()) return name;
  throw xrds::Error("No model is shipped that upscales by " + std::to_string(known) + " (" + name +
                    "): render at another size, or name a .safetensors file.");
}

}  // namespace

XrdsResult xrdsChooseModel(uint32_t scale, const char* const* inputs, uint32_t inputCount, double samples, char* name,
                           size_t capacity) {
  return guarded([&] {
    std::vector<std::string_view> images;
    for (uint32_t i = 0; i < inputCount; ++i)
      images.emplace_back(&required((&required(inputs, "inputs"))[i], "inputs"));
    copyText(chosenModel(scale, images, samples), name, "name", capacity);
    return XRDS_OK;
  });
}

XrdsResult xrdsFindModel(const char* name, char* path, size_t capacity) {
  return guarded([&] {
    copyText(fileOf(&required(name, "name")).string(), path, "path", capacity);
    return XRDS_OK;
  });
}

XrdsResult xrdsOpenModel(const char* nameOrFile, XrdsModel** model) {
  return guarded([&] {
    XrdsModel*& out = required(model, "model");
    out = Models::open().add(std::make_shared<XrdsModel>(fileOf(&required(nameOrFile, "nameOrFile"))));
    return XRDS_OK;
  });
}

void xrdsCloseModel(XrdsModel* model) {
  guarded([&] {
    Models::open().remove(model);
    return XRDS_OK;
  });
}

uint32_t xrdsGetModelScale(const XrdsModel* model) {
  const auto found = Models::open().find(model);
  return found ? found->model.scale() : 0;
}

uint32_t xrdsCountModelInputs(const XrdsModel* model) {
  const auto found = Models::open().find(model);
  return found ? static_cast<uint32_t>(found->model.auxiliaryInputs().size()) : 0;
}

const char* xrdsGetModelInput(const XrdsModel* model, uint32_t index) {
  const auto found = Models::open().find(model);
  return found && index < found->model.auxiliaryInputs().size() ? found->model.auxiliaryInputs()[index].c_str()
                                                                : nullptr;
}

const char* xrdsGetModelMetadata(const XrdsModel* model, const char* key) {
  const char* text = nullptr;
  guarded([&] {
    const auto found = Models::open().find(model);
    if (!found || !key) return XRDS_OK;
    const auto& metadata = found->model.metadata();
    if (const auto field = metadata.find(key); field != metadata.end()) text = field->second.c_str();
    return XRDS_OK;
  });
  return text;
}

XrdsResult xrdsMergeColour(const XrdsImage* low, const XrdsImage* full, double lowSamples, double fullSamples,
                           const XrdsImage* merged) {
  return guarded([&] {
    const ReadImage colour(required(low, "low"), "low-resolution"), detail(required(full, "full"), "full-resolution");
    checkImage(required(merged, "merged"), "merged", 3);
    if (merged->width != low->width || merged->height != low->height)
      throw xrds::InvalidArgument("The merged image must have the size of the low-resolution one.");
    const bool known = lowSamples != 0 || fullSamples != 0;
    const double share = known ? xrds::fullShare({lowSamples, fullSamples}, full->width / low->width)
                               : xrds::estimatedFullShare(colour.view(), detail.view());
    const std::vector<float> pixels = xrds::mergedColour(colour.view(), detail.view(), share);
    const std::vector<float> alpha = low->channels[3] ? readChannel(*low, 3) : std::vector<float>();
    for (uint32_t c = 0; c < 3; ++c) writeChannel(*merged, c, &pixels[c], 3);
    if (merged->channels[3]) {
      const float opaque = 1;
      writeChannel(*merged, 3, alpha.empty() ? &opaque : alpha.data(), alpha.empty() ? 0 : 1);
    }
    return XRDS_OK;
  });
}

XrdsResult xrdsCompareColour(const XrdsImage* low, const XrdsImage* full, double* difference) {
  return guarded([&] {
    const ReadImage colour(required(low, "low"), "low-resolution"), detail(required(full, "full"), "full-resolution");
    required(difference, "difference") = xrds::colourDifference(colour.view(), detail.view());
    return XRDS_OK;
  });
}
