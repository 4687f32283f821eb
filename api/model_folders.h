#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace xrds {

/// modelFolders() of the public API.
std::vector<std::filesystem::path> foldersOfModels();
/// The file of a shipped model by its name; empty if none of the folders has it.
std::filesystem::path modelFile(const std::string& name);

}  // namespace xrds
