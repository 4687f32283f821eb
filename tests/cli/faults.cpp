#include "tests/cli/faults.h"

#include <fstream>
#include <nlohmann/json.hpp>

namespace xrds::test {

namespace fs = std::filesystem;

StartOptions withFaults(const std::string& rules, const fs::path& log) {
  StartOptions options{.environment = {{"VK_LAYER_PATH", XRDS_FAULT_LAYER},
                                       {"VK_INSTANCE_LAYERS", "VK_LAYER_XRDS_faults"},
                                       {"XRDS_FAULTS", rules}}};
  options.environment["LSAN_OPTIONS"] = "detect_leaks=0";  // what a device that does not answer holds is abandoned
  if (!log.empty()) options.environment["XRDS_FAULTS_LOG"] = log.string();
  return options;
}

namespace {

fs::path lavapipeManifest() {
  fs::path manifest;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator("/usr/share/vulkan/icd.d", failure))
    if (entry.path().filename().string().starts_with("lvp_icd")) manifest = entry.path();
  return manifest;
}

}  // namespace

bool makePortabilityDriver(StartOptions& options, const fs::path& folder) {
  const fs::path manifest = lavapipeManifest();
  if (manifest.empty()) return false;
  std::ifstream file(manifest);
  nlohmann::json content = nlohmann::json::parse(file);
  content["ICD"]["is_portability_driver"] = true;
  const std::string made = (folder / "portability.json").string();
  std::ofstream(made) << content;
  options.environment["VK_DRIVER_FILES"] = options.environment["VK_ICD_FILENAMES"] = made;
  return true;
}

bool addSecondDevice(StartOptions& options, const fs::path& folder) {
  const fs::path manifest = lavapipeManifest();
  if (manifest.empty()) return false;
  std::string files;
  for (const char* name : {"first.json", "second.json"}) {
    fs::copy_file(manifest, folder / name);
    files += (files.empty() ? "" : ":") + (folder / name).string();
  }
  options.environment["VK_DRIVER_FILES"] = options.environment["VK_ICD_FILENAMES"] = files;
  return true;
}

}  // namespace xrds::test
