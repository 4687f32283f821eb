#include "app/models.h"

#include <algorithm>

#include "app/listed.h"
#include "image/exr/file.h"
#include "xrds/error.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;
namespace {

constexpr const char* kSuffix = ".safetensors";
constexpr int kScaleOfColourAlone = 4;  // no image tells another

std::string placesOfModels() {
  std::string folders;
  for (const fs::path& folder : modelFolders())
    folders += (folders.empty() ? "'" : " or '") + folder.lexically_normal().string() + "'";
  return folders;
}

// Where no model is found at all.
std::string noModels() {
  return "no model is found in " + placesOfModels() + ": install xrds again, or name a .safetensors file with --model.";
}

std::string nameOf(int scale, const char* kind) { return "xrds-x" + std::to_string(scale) + "-" + kind; }

std::string variantOf(int scale, const std::vector<std::string>& inputs, std::optional<double> samples = {}) {
  return variantName(static_cast<uint32_t>(scale), std::vector<std::string_view>(inputs.begin(), inputs.end()),
                     samples);
}

}  // namespace

fs::path inModelFolders(const std::string& fileName) {
  std::error_code ignored;
  for (const fs::path& folder : modelFolders())
    if (fs::path file = folder / pathOf(fileName); fs::exists(file, ignored)) return file;
  return {};
}

fs::path resolveModel(const std::string& nameOrFile) {
  fs::path given = pathOf(nameOrFile);
  if (nameOrFile.ends_with(kSuffix) || given.has_parent_path()) return given;
  if (fs::path file = findModel(nameOrFile); !file.empty()) return file;
  std::error_code ignored;  // a name too long for a file, say
  if (fs::is_regular_file(given, ignored)) return given;
  if (shippedModels().empty()) throw Error("There is no model '" + nameOrFile + "', and " + noModels());
  throw Error("There is no model '" + nameOrFile + "': give a .safetensors file or one of the shipped models, " +
              listed(shippedModels()) + ".");
}

void requireShippedModels() {
  if (shippedModels().empty())
    throw Error("No model is found in " + placesOfModels() +
                ": install xrds again, or let XRDS_MODELS name their folder.");
}

std::string defaultModelName(int scale) { return nameOf(scale, "compact"); }

std::string liveModelName() { return nameOf(4, "mini"); }

bool takes(const Model& model, const AuxiliaryInput& input) {
  const auto& inputs = model.auxiliaryInputs();
  return std::find(inputs.begin(), inputs.end(), input.name) != inputs.end();
}

void requireKnownInputs(const Model& model, const std::string& modelName) {
  for (const std::string& input : model.auxiliaryInputs())
    if (!findAuxiliaryInput(input))
      throw Error("Model '" + modelName + "' needs the auxiliary image '" + printable(input) +
                  "', which this program cannot find in an EXR file: use the library.");
}

fs::path shippedVariant(int scale, const std::vector<std::string>& inputs) {
  return findModel(variantOf(scale, inputs));
}

fs::path defaultModel(int scale, const std::vector<std::string>& inputs, std::optional<double> samples) {
  if (inputs.empty()) return resolveModel(variantOf(kScaleOfColourAlone, inputs));
  if (fs::path variant = findModel(variantOf(scale, inputs, samples)); !variant.empty()) return variant;
  fs::path file = findModel(defaultModelName(scale));
  if (file.empty() && shippedModels().empty())
    throw Error("Without --model a shipped model is taken, but " + noModels());
  if (file.empty())
    throw Error("The auxiliary images have " + (scale == 1 ? "the" : std::to_string(scale) + " times the") +
                " colour's size and no model of this scale is shipped, only " + listed(shippedModels()) +
                ": render at another size or name a model with --model.");
  return file;
}

}  // namespace xrds
