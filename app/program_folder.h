#pragma once

#include <filesystem>

namespace xrds {

/// The folder of the running program; empty where the system does not tell. Linux, Windows and macOS do.
std::filesystem::path programFolder();

}  // namespace xrds
