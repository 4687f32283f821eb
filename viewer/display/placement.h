#pragma once

#include <filesystem>

#include "viewer/display/display.h"

namespace xrds {

/// The file in which the viewer remembers its display: $XDG_CONFIG_HOME/xrds/viewer.json, else in ~/.config,
/// %APPDATA% or a temporary folder.
std::filesystem::path placementFile();

/// The placement that was written; the default one if there is none or it cannot be understood.
Placement readPlacement(const std::filesystem::path& file);

/// Failing to write is no error: the display then opens as if for the first time.
void writePlacement(const std::filesystem::path& file, const Placement& placement) noexcept;

}  // namespace xrds
