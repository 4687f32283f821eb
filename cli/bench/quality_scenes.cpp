#include "cli/bench/quality_scenes.h"

#include <algorithm>
#include <cctype>

#include "app/models.h"
#include "cli/report.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;
namespace {

constexpr const char* kReferenceSuffix = "_gt.exr";

// s12.exr and s12_clean.exr belong to scene s12, s123.exr does not.
bool belongsTo(const std::string& fileName, const std::string& scene) {
  return fileName.starts_with(scene) && fileName.ends_with(".exr") &&
         std::isalnum(static_cast<unsigned char>(fileName[scene.size()])) == 0;
}

std::vector<std::string> fileNames(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) names.push_back(entry.path().filename().string());
  if (error) throw Error("Cannot read the folder '" + folder.string() + "': " + error.message() + ".");
  std::sort(names.begin(), names.end());
  return names;
}

// Nothing if a file is missing.
std::optional<SceneFiles> filesOf(const fs::path& folder, const std::string& scene, const QualitySetting& setting,
                                  const std::vector<FinishedImages>& finished) {
  SceneFiles files{scene, folder / pathOf(scene + kReferenceSuffix), folder / pathOf(scene + setting.colourSuffix()),
                   folder / pathOf(scene + setting.auxSuffix())};
  if (!fs::exists(files.colour) || !fs::exists(files.aux)) return {};
  for (const FinishedImages& images : finished) {
    const auto file = images.find(scene);
    if (!file) return {};
    files.finished.push_back(*file);
  }
  return files;
}

std::string expectedFiles(const QualitySetting& setting, const std::vector<FinishedImages>& finished) {
  std::string text = std::string("NAME") + kReferenceSuffix + ", NAME" + setting.colourSuffix();
  if (setting.auxSuffix() != setting.colourSuffix() && setting.auxSuffix() != kReferenceSuffix)
    text += ", NAME" + setting.auxSuffix();
  for (const FinishedImages& images : finished) text += ", and an image in '" + images.place + "'";
  return text;
}

}  // namespace

std::string QualitySetting::colourSuffix() const {
  const std::string kind = scale == 1 ? "aux" : scale == 4 ? "lr" : "x" + std::to_string(scale) + "lr";
  return "_" + kind + std::to_string(colourSamples) + ".exr";
}

std::string QualitySetting::auxSuffix() const {
  return auxSamples ? "_aux" + std::to_string(*auxSamples) + ".exr" : kReferenceSuffix;
}

void QualitySetting::read(const Model& model) {
  for (const std::string& input : model.auxiliaryInputs())
    if (std::find(inputs.begin(), inputs.end(), input) == inputs.end()) inputs.push_back(input);
  if (takes(model, kFullColour)) mergesColour = true;
}

QualitySetting settingFor(const Model& model, int colour, int aux) {
  const int scale = static_cast<int>(model.scale());
  QualitySetting setting{.scale = scale, .colourSamples = scale == 1 ? aux : colour, .auxSamples = aux};
  setting.read(model);
  return setting;
}

std::string QualitySetting::auxText() const { return auxSamples ? std::to_string(*auxSamples) : "converged"; }

std::optional<double> QualitySetting::averageSamples() const {
  if (!auxSamples) return {};
  const double colour = static_cast<double>(colourSamples) / (scale * scale);
  return colourSuffix() == auxSuffix() ? colour : colour + *auxSamples;
}

std::optional<fs::path> FinishedImages::find(const std::string& scene) const {
  if (const size_t star = place.find('*'); star != std::string::npos) {
    const fs::path file = pathOf(std::string(place).replace(star, 1, scene));
    return fs::exists(file) ? std::optional(file) : std::nullopt;
  }
  std::vector<std::string> fitting;
  for (const std::string& file : fileNames(pathOf(place)))
    if (belongsTo(file, scene)) fitting.push_back(file);
  if (fitting.size() > 1)
    throw Error("'" + place + "' has several images of scene '" + scene + "', " + printable(fitting[0]) + " and " +
                printable(fitting[1]) + ": give a pattern such as '" + (pathOf(place) / "*_oidn.exr").string() +
                "', where * is the scene's name.");
  return fitting.empty() ? std::nullopt : std::optional(pathOf(place) / pathOf(fitting[0]));
}

SceneList findScenes(const fs::path& folder, const QualitySetting& setting,
                     const std::vector<FinishedImages>& finished) {
  SceneList list;
  for (const std::string& file : fileNames(folder)) {
    if (!file.ends_with(kReferenceSuffix)) continue;
    const std::string scene = file.substr(0, file.size() - std::string(kReferenceSuffix).size());
    if (auto files = filesOf(folder, scene, setting, finished))
      list.scenes.push_back(std::move(*files));
    else
      list.skipped.push_back(scene);
  }
  if (list.scenes.empty())
    throw Error("The folder '" + folder.string() + "' has no scene with all of " + expectedFiles(setting, finished) +
                " (" + std::to_string(list.skipped.size()) + " with a reference).");
  return list;
}

Scene loadScene(const SceneFiles& files, const QualitySetting& setting) {
  MergeRequest merge{.never = !setting.mergesColour || !setting.auxSamples};  // never with the reference's own colour
  if (!merge.never) merge.samples = {double(setting.colourSamples), double(*setting.auxSamples)};
  Scene scene{Frame(files.colour, files.aux, {}, setting.inputs, merge), {}, {}};
  if (scene.frame.scale() != setting.scale)
    throw Error("'" + files.aux.string() + "' has " + std::to_string(scene.frame.scale()) + " times the size of '" +
                files.colour.string() + "', expected " + std::to_string(setting.scale) + " times.");
  scene.frame.load();
  const int width = setting.scale * scene.frame.colour().width, height = setting.scale * scene.frame.colour().height;
  scene.reference = readReference(files.reference.string(), width, height);
  for (const fs::path& file : files.finished)
    scene.finished.push_back(readFullSize(file.string(), "finished image", width, height));
  return scene;
}

}  // namespace xrds
