#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "xrds/export.h"

namespace xrds {

/// Folders in which shipped models are looked for, in this order: that of the environment variable XRDS_MODELS;
/// share/xrds/models of the library's own folder (of the program's, if it is linked statically) and of each above it,
/// two up, which finds lib/x86_64-linux-gnu, lib and bin beside share; the source tree that it was built from, except
/// in packages. On Windows and macOS the same: there the library is bin/libxrds.dll and lib/libxrds.dylib.
XRDS_API std::vector<std::filesystem::path> modelFolders();

/// The file of a shipped model by its name, as "xrds-x4-compact"; empty if none of the folders has it.
XRDS_API std::filesystem::path findModel(const std::string& name);

/// Of the low-resolution colour: with at most so many samples a pixel the models of few samples make the better picture
/// (bench/budgets.md).
inline constexpr double kFewSamples = 4;

/// The name of the model that suits frames with these auxiliary images (names of AuxiliaryInput), whether it is shipped
/// for the scale or not: of the colour alone, without normals, with the full-resolution colour, of few samples a pixel
/// of the low-resolution colour, where these are known, or "xrds-x4-compact" with the scale in the place of the 4.
XRDS_API std::string variantName(uint32_t scale, std::span<const std::string_view> inputs,
                                 std::optional<double> samples = {});

}  // namespace xrds
