#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace xrds {

/// Folders in which shipped models are looked for: $XRDS_MODELS, beside the installed program, in the source tree.
std::vector<std::filesystem::path> modelFolders();

/// The file of a model given by name ("xrds-x4-compact") or by path. Throws Error that lists the models there are.
std::filesystem::path resolveModel(const std::string& nameOrFile);

/// The default model of a scale, "xrds-x<scale>-compact".
std::string defaultModel(int scale);

}  // namespace xrds
