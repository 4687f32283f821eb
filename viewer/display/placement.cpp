#include "viewer/display/placement.h"

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "image/pending_file.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;
namespace {

fs::path configFolder() {
  if (const char* folder = std::getenv("XDG_CONFIG_HOME"); folder && pathOf(folder).is_absolute())
    return pathOf(folder);
  if (const char* home = std::getenv("HOME"); home && *home) return pathOf(home) / ".config";
  if (const char* folder = std::getenv("APPDATA"); folder && *folder) return pathOf(folder);
  return fs::temp_directory_path();
}

}  // namespace

fs::path placementFile() { return configFolder() / "xrds" / "viewer.json"; }

Placement readPlacement(const fs::path& file) {
  constexpr int kMost = 16384;
  Placement placement;
  std::ifstream stream(file);
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
  if (!json.is_object()) return placement;
  const auto number = [&](const char* key, int least) -> std::optional<int> {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_number_integer()) return std::nullopt;
    const auto value = found->get<int64_t>();
    return value >= least && value <= kMost ? std::optional(static_cast<int>(value)) : std::nullopt;
  };
  placement.width = number("width", 320).value_or(placement.width);
  placement.height = number("height", 240).value_or(placement.height);
  placement.x = number("x", -kMost);
  placement.y = number("y", -kMost);
  placement.maximized = json.value("maximized", nlohmann::json(false)) == true;
  return placement;
}

void writePlacement(const fs::path& file, const Placement& placement) noexcept {
  try {
    fs::create_directories(file.parent_path());
    nlohmann::json json = {
        {"width", placement.width}, {"height", placement.height}, {"maximized", placement.maximized}};
    if (placement.x && placement.y) json["x"] = *placement.x, json["y"] = *placement.y;
    PendingFile pending(file);
    std::ofstream(pending.temporaryPath()) << json.dump(2) << "\n";
    pending.commit();
  } catch (const std::exception&) {  // see the header
  }
}

}  // namespace xrds
