#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace xrds {

/// The folder where a device keeps its caches, which exists and can be written: the asked one (empty: the user's), else
/// a temporary one that only this user can write, as what lies there is run. Empty if there is neither. Adds a sentence
/// to the notes if it is not the asked one. Tells the same of Mesa's shader cache, where $MESA_SHADER_CACHE_DIR places
/// it, and takes that back. Changes the environment: see environment.h.
std::filesystem::path chooseCacheFolder(const std::filesystem::path& asked, std::vector<std::string>& notes);

/// The same without a word of Mesa's shader cache, and without a change of the environment.
std::filesystem::path writableCacheFolder(const std::filesystem::path& asked, std::vector<std::string>& notes);

/// Whether files can be made in the folder, which is made if it is missing.
bool canWriteFiles(const std::filesystem::path& folder);

}  // namespace xrds
