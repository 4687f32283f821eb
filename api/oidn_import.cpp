#include "api/oidn_import.h"

#include "engine/environment.h"
#include "network/oidn_import.h"
#include "xrds/error.h"

namespace xrds {
namespace fs = std::filesystem;

std::vector<fs::path> writeOidnModels(const fs::path& library, const fs::path& folder) {
  const std::vector<ImportedNetwork> networks = importNetworks(library);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error("Cannot make the folder '" + folder.string() + "': " + error.message() + ".");
  std::vector<fs::path> files;
  for (const ImportedNetwork& network : networks) {
    files.push_back(folder / (network.name + ".safetensors"));
    writeTensors(files.back(), network.file, DataType::f16);  // as they are stored there
  }
  return files;
}

fs::path folderOfDenoisers() {
  if (fs::path own = environmentPath("XRDS_DENOISERS"); !own.empty()) return own;
#if defined(_WIN32)
  const fs::path data = environmentPath("LOCALAPPDATA");
#else
  fs::path data = userFolder("XDG_DATA_HOME");
  if (const fs::path home = environmentPath("HOME"); data.empty() && !home.empty()) data = home / ".local/share";
#endif
  return data.empty() ? data : data / "xrds" / "denoisers";
}

}  // namespace xrds
