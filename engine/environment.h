#pragma once

#include <filesystem>
#include <string>

namespace xrds {

/// The folder in which caches are kept unless the caller names one: $XDG_CACHE_HOME/xrds, ~/.cache/xrds,
/// %LOCALAPPDATA%/xrds, or a temporary folder.
std::filesystem::path defaultCacheFolder();

/// What the user set XRDS_KERNEL_FAMILY to; empty if nothing.
std::string wantedKernelFamily();

/// Lets lavapipe use the CPU's whole vector width unless the user chose one. Changes the environment, so call it
/// before an instance is created and while no other thread reads the environment.
void widenCpuVectors();

/// Takes that back, for the life of the process. Returns whether there was anything to take back; then an instance that
/// is created after all others were destroyed has vectors of 256 bits.
bool narrowCpuVectors();

/// Gives Mesa a shader cache of its own for the chosen width, because its own key leaves the width out and code of
/// the wrong width returns garbage.
void separateShaderCache(const std::filesystem::path& cacheFolder);

}  // namespace xrds
