#pragma once

#include <filesystem>
#include <vector>

namespace xrds {

/// importOidn() and denoiserFolder() of the public API, which documents them.
std::vector<std::filesystem::path> writeOidnModels(const std::filesystem::path& library,
                                                   const std::filesystem::path& folder);
std::filesystem::path folderOfDenoisers();

}  // namespace xrds
