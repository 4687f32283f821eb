#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "xrds/auxiliary_input.h"
#include "xrds/call.h"
#include "xrds/xrds_report.h"

namespace xrds {

/// Folders in which shipped models are looked for, in this order: that of the environment variable XRDS_MODELS;
/// share/xrds/models of the library's own folder (of the program's, if it is linked statically) and of each above it,
/// two up, which finds lib/x86_64-linux-gnu, lib and bin beside share; the source tree that it was built from, except
/// in packages. On Windows and macOS the same: there the library is bin/libxrds.dll and lib/libxrds.dylib.
inline std::vector<std::filesystem::path> modelFolders() {
  std::vector<std::filesystem::path> folders;
  while (const char* folder = xrdsGetModelFolder(static_cast<uint32_t>(folders.size())))
    folders.push_back(pathOf(folder));
  return folders;
}

/// The file of a shipped model by its name, as "xrds-x4-compact"; empty if none of the folders has it.
inline std::filesystem::path findModel(const std::string& name) {
  std::error_code ignored;
  for (const std::filesystem::path& folder : modelFolders())
    if (std::filesystem::path file = folder / pathOf(name + ".safetensors"); std::filesystem::exists(file, ignored))
      return file;
  return {};
}

/// The names of the shipped models in all folders, in alphabetical order.
inline std::vector<std::string> shippedModels() {
  std::vector<std::string> names;
  for (const std::filesystem::path& folder : modelFolders()) {
    std::error_code error;
    for (std::filesystem::directory_iterator file(folder, error), end; !error && file != end; file.increment(error))
      if (file->path().extension() == ".safetensors") names.push_back(file->path().stem().string());
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

/// Of the low-resolution colour: with at most so many samples a pixel the models of few samples make the better picture
/// (bench/budgets.md).
inline constexpr double kFewSamples = 4;

/// The name of the model that suits frames with these auxiliary images (names of AuxiliaryInput), whether it is shipped
/// for the scale or not: of the colour alone, without normals, with the full-resolution colour, of few samples a pixel
/// of the low-resolution colour, where these are known, or "xrds-x4-compact" with the scale in the place of the 4.
/// chooseModel() names one that is.
inline std::string variantName(uint32_t scale, std::span<const std::string_view> inputs,
                               std::optional<double> samples = {}) {
  const auto has = [&](const AuxiliaryInput& input) {
    return std::find(inputs.begin(), inputs.end(), input.name) != inputs.end();
  };
  const std::string name = "xrds-x" + std::to_string(scale);
  if (inputs.empty()) return name + "-compact-plain";
  if (!has(kNormal)) return name + "-compact-albedo";
  if (has(kFullColour)) return name + "-full";
  return name + (samples && *samples <= kFewSamples ? "-live" : "-compact");
}

/// The name of the shipped model that suits such frames: variantName(), or the compact one where that is not shipped
/// for the scale. Without images it is the model of the colour alone, of scale 4 whatever `scale` is. Throws Error that
/// lists the shipped models if none is of the scale.
inline std::string chooseModel(uint32_t scale, std::span<const std::string_view> inputs,
                               std::optional<double> samples = {}) {
  const std::vector<std::string> names(inputs.begin(), inputs.end());
  std::vector<const char*> words;
  for (const std::string& name : names) words.push_back(name.c_str());
  char chosen[256] = "";
  call::check(xrdsChooseModel(scale, words.data(), static_cast<uint32_t>(words.size()), samples.value_or(0), chosen,
                              sizeof chosen));
  return chosen;
}

}  // namespace xrds
