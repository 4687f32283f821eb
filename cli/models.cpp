#include "cli/models.h"

#include <algorithm>
#include <cstdlib>

#include "xrds/error.h"

namespace xrds {
namespace fs = std::filesystem;
namespace {

constexpr const char* kSuffix = ".safetensors";

fs::path programFolder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);  // elsewhere: $XRDS_MODELS or a path
  return error ? fs::path() : program.parent_path();
}

std::string shippedModels() {
  std::vector<std::string> names;
  for (const fs::path& folder : modelFolders()) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
      if (entry.path().extension() == kSuffix) names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

}  // namespace

std::vector<fs::path> modelFolders() {
  std::vector<fs::path> folders;
  if (const char* folder = std::getenv("XRDS_MODELS")) folders.emplace_back(folder);
  if (const fs::path program = programFolder(); !program.empty()) folders.push_back(program / "../share/xrds/models");
  folders.emplace_back(XRDS_MODEL_FOLDER);
  return folders;
}

fs::path resolveModel(const std::string& nameOrFile) {
  if (nameOrFile.ends_with(kSuffix) || nameOrFile.find('/') != std::string::npos) return nameOrFile;
  for (const fs::path& folder : modelFolders()) {
    const fs::path file = folder / (nameOrFile + kSuffix);
    if (fs::exists(file)) return file;
  }
  if (fs::is_regular_file(nameOrFile)) return nameOrFile;
  throw Error("There is no model '" + nameOrFile + "': give a .safetensors file or one of the shipped models: " +
              shippedModels() + ".");
}

std::string defaultModel(int scale) { return "xrds-x" + std::to_string(scale) + "-compact"; }

}  // namespace xrds
