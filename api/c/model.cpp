#include <cstring>

#include "api/c/handles.h"
#include "api/c/result.h"
#include "api/c/sized.h"
#include "api/model_folders.h"
#include "frames/quiet_windows.h"
#include "xrds/auxiliary_input.h"
#include "xrds/shipped_models.h"
#include "xrds/xrds_report.h"

using namespace xrds::c;

XrdsModel::XrdsModel(xrds::NetworkModel read)
    : model(std::move(read)), hash(xrds::hashText(model)), whyNeverSkipped(xrds::whyNeverQuiet(model.config())) {}

namespace {

// "xrds-x2-compact, xrds-x4-compact"; empty if none is shipped.
std::string listedModels() {
  std::string listed;
  for (const std::string& name : xrds::shippedModels()) listed += (listed.empty() ? "" : ", ") + name;
  return listed;
}

// A name without a folder or an ending is a shipped model's.
std::filesystem::path fileOf(const std::string& nameOrFile) {
  std::error_code ignored;  // a name too long for a file, say
  if (const auto path = pathOf(nameOrFile.c_str());
      nameOrFile.ends_with(".safetensors") || path.has_parent_path() || is_regular_file(path, ignored))
    return path;
  std::filesystem::path file = xrds::modelFile(nameOrFile);
  if (!file.empty()) return file;
  if (const std::string shipped = listedModels(); !shipped.empty())
    throw xrds::Error("There is no model '" + nameOrFile +
                      "': give a .safetensors file or one of the shipped models, " + shipped + ".");
  std::string folders;
  for (const auto& folder : xrds::foldersOfModels())
    folders += (folders.empty() ? "'" : " or '") + folder.string() + "'";
  throw xrds::Error("There is no model '" + nameOrFile + "', and no other in " + folders +
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
  if (!xrds::modelFile(name).empty()) return name;
  constexpr std::string_view kBoth[] = {xrds::kAlbedo.name, xrds::kNormal.name};
  if (name = inputs.empty() ? name : xrds::variantName(known, kBoth); !xrds::modelFile(name).empty()) return name;
  const std::string shipped = listedModels();
  throw xrds::Error("No model is shipped that upscales by " + std::to_string(known) + " (" + name + ")" +
                    (shipped.empty() ? "" : ", only " + shipped) +
                    ": render at another size, or name a .safetensors file.");
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
    const std::filesystem::path file = fileOf(&required(name, "name"));
    std::error_code ignored;
    if (!is_regular_file(file, ignored)) throw xrds::Error("There is no file '" + file.string() + "'.");
    copyText(xrds::call::text(file), path, "path", capacity);
    return XRDS_OK;
  });
}

XrdsResult xrdsOpenModel(const char* nameOrFile, XrdsModel** model) {
  return guarded([&] {
    XrdsModel*& out = required(model, "model");
    out = Models::open().add(
        std::make_shared<XrdsModel>(xrds::NetworkModel::read(fileOf(&required(nameOrFile, "nameOrFile")))));
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
  return found ? found->scale() : 0;
}

uint32_t xrdsCountModelInputs(const XrdsModel* model) {
  const auto found = Models::open().find(model);
  return found ? static_cast<uint32_t>(found->inputs().size()) : 0;
}

const char* xrdsGetModelInput(const XrdsModel* model, uint32_t index) {
  const auto found = Models::open().find(model);
  return found && index < found->inputs().size() ? found->inputs()[index].c_str() : nullptr;
}

const char* xrdsGetModelMetadata(const XrdsModel* model, const char* key) {
  const char* text = nullptr;
  guarded([&] {
    const auto found = Models::open().find(model);
    if (!found || !key) return XRDS_OK;
    const auto& metadata = found->model.file().metadata;
    if (const auto field = metadata.find(key); field != metadata.end()) text = field->second.c_str();
    return XRDS_OK;
  });
  return text;
}

const char* xrdsGetModelMetadataKey(const XrdsModel* model, uint32_t index) {
  const auto found = Models::open().find(model);
  if (!found || index >= found->model.file().metadata.size()) return nullptr;
  return std::next(found->model.file().metadata.begin(), index)->first.c_str();
}

const char* xrdsGetModelHash(const XrdsModel* model) {
  const auto found = Models::open().find(model);
  return found ? found->hash.c_str() : "";
}

const char* xrdsWhyNeverSkipped(const XrdsModel* model) {
  const auto found = Models::open().find(model);
  return found ? found->whyNeverSkipped.c_str() : "";
}

const char* xrdsGetModelFolder(uint32_t index) {
  thread_local std::string text;
  const char* folder = nullptr;
  guarded([&] {
    const auto folders = xrds::foldersOfModels();
    if (index >= folders.size()) return XRDS_OK;
    text = xrds::call::text(folders[index]);
    folder = text.c_str();
    return XRDS_OK;
  });
  return folder;
}

XrdsResult xrdsCreateUntrainedModel(uint32_t scale, const char* base, const char* transfer, XrdsModel** model) {
  return guarded([&] {
    XrdsModel*& out = required(model, "model");
    out = Models::open().add(std::make_shared<XrdsModel>(
        xrds::untrainedModel(scale, &required(base, "base"), &required(transfer, "transfer"))));
    return XRDS_OK;
  });
}

XrdsResult xrdsGetModelCost(const XrdsModel* model, uint32_t outputWidth, uint32_t outputHeight, int32_t fp16,
                            const char* kernelFamily, XrdsModelCost* cost) {
  return guarded([&] {
    const auto found = Models::open().opened(model, "model");
    const xrds::Model::Cost sum =
        xrds::costOf(found->model, outputWidth, outputHeight, fp16 != 0, &required(kernelFamily, "kernelFamily"));
    give<XrdsModelCost>({.structSize = sizeof(XrdsModelCost),
                         .parameters = sum.parameters,
                         .networkMultiplyAdds = sum.networkMultiplyAdds,
                         .multiplyAdds = sum.multiplyAdds,
                         .attentionMultiplyAdds = sum.attentionMultiplyAdds,
                         .plannedBytes = sum.plannedBytes,
                         .lowerBoundBytes = sum.lowerBoundBytes,
                         .unaliasedBytes = sum.unaliasedBytes,
                         .weightBytes = sum.weightBytes},
                        required(cost, "cost"));
    return XRDS_OK;
  });
}
