#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace xrds {

/// A variable of the environment; empty if it is not set. May be called while another thread of the library changes
/// one.
std::string environmentVariable(const char* name);

/// The file or folder that a variable names, whatever its letters; empty if it is not set.
std::filesystem::path environmentPath(const char* name);

/// The folder that a variable such as XDG_CACHE_HOME names; empty if it is not set, or relative: the XDG Base Directory
/// Specification has such paths ignored.
std::filesystem::path userFolder(const char* name);

/// The folder in which caches are kept unless the caller names one: $XDG_CACHE_HOME/xrds, ~/.cache/xrds,
/// %LOCALAPPDATA%/xrds, or a temporary folder.
std::filesystem::path defaultCacheFolder();

/// A folder of this user's among the temporary ones. It may be another's who guessed its name.
std::filesystem::path temporaryCacheFolder();

/// Where the user's MESA_SHADER_CACHE_DIR places Mesa's shader cache; empty if it does not.
std::filesystem::path usersShaderCacheFolder();

/// Places Mesa's shader cache instead of the user, with widenCpuVectors()'s conditions.
void placeShaderCache(const std::filesystem::path& folder);

/// What the user set XRDS_KERNEL_FAMILY to; empty if nothing.
std::string wantedKernelFamily();

/// The processor's own name of itself and the number of its threads: "AMD EPYC, 2 threads".
std::string processorName();

/// Bytes of the second-level cache of a core; the default of DeviceTraits where the system does not tell.
uint64_t secondCacheBytes();

/// Lets lavapipe use the CPU's whole vector width unless the user chose one, or it is loaded already. Changes the
/// environment, so call it before an instance is created and while no other thread reads the environment.
void widenCpuVectors();

/// Gives Mesa a shader cache of its own for the chosen width, because its own key leaves the width out and code of
/// the wrong width returns garbage.
void separateShaderCache(const std::filesystem::path& cacheFolder);

}  // namespace xrds
