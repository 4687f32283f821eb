#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "xrds/export.h"

namespace xrds {

/// Folders in which shipped models are looked for, in this order: that of the environment variable XRDS_MODELS;
/// share/xrds/models of each folder above the library's own (of the program's, if it is linked statically), two up,
/// which finds lib/x86_64-linux-gnu, lib and bin beside share; the source tree that it was built from.
XRDS_API std::vector<std::filesystem::path> modelFolders();

/// The file of a shipped model by its name, as "xrds-x4-compact"; empty if none of the folders has it.
XRDS_API std::filesystem::path findModel(const std::string& name);

}  // namespace xrds
