#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace xrds {

/// The folder of the running program; empty where the system does not tell.
std::filesystem::path programFolder();

/// Folders in which shipped models are looked for: $XRDS_MODELS, beside the installed program, in the source tree.
std::vector<std::filesystem::path> modelFolders();

/// The shipped models' names, in alphabetical order.
std::vector<std::string> shippedModels();

/// The file of a model given by name ("xrds-x4-compact") or by path. Throws Error that lists the models there are.
std::filesystem::path resolveModel(const std::string& nameOrFile);

/// "xrds-x<scale>-compact", whether it is shipped or not.
std::string defaultModelName(int scale);

/// The file of the default model of a scale: the one that does without normals where there are none, if it is shipped.
/// Throws Error as resolveModel does.
std::filesystem::path defaultModel(int scale, bool hasNormal);

/// The file of the default model's variant for frames with other auxiliary images, "albedo" or "plain"; empty if none
/// is shipped for the scale.
std::filesystem::path shippedVariant(int scale, const std::string& variant);

}  // namespace xrds
