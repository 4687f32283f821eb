#include "engine/environment.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <mutex>
#include <thread>
#if (defined(__x86_64__) || defined(__i386__)) && defined(__GNUC__)
#include <cpuid.h>
#endif

#ifndef _WIN32
#include <unistd.h>
#endif
#ifdef __linux__
#include <link.h>

#include <string_view>
#endif

#include "engine/device_traits.h"

namespace xrds {
namespace {

// The C library lets nobody read the environment while another thread changes it.
std::mutex access;

// The text is one of ASCII, or a path.
void setVariable(const char* name, const std::filesystem::path& text) {
  const std::lock_guard lock(access);
#ifdef _WIN32
  _wputenv_s(std::filesystem::path(name).c_str(), text.c_str());
#else
  setenv(name, text.c_str(), 1);
#endif
}

bool cpuHasAvx512() {
#if (defined(__x86_64__) || defined(__i386__)) && defined(__GNUC__)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

std::string brandOfProcessor() {
#if (defined(__x86_64__) || defined(__i386__)) && defined(__GNUC__)
  std::array<unsigned, 12> words{};
  for (unsigned leaf = 0; leaf < 3; ++leaf)
    if (!__get_cpuid(0x80000002 + leaf, &words[4 * leaf], &words[4 * leaf + 1], &words[4 * leaf + 2],
                     &words[4 * leaf + 3]))
      return "CPU";
  const std::string brand(reinterpret_cast<const char*>(words.data()), sizeof words);
  return brand.substr(0, std::min(brand.find('\0'), brand.size()));
#else
  return "CPU";
#endif
}

// Mesa takes an empty folder for one that it cannot make, and keeps nothing.
void leaveToDriverIfEmpty([[maybe_unused]] const char* name) {
#ifndef _WIN32
  if (!environmentVariable(name).empty()) return;
  const std::lock_guard lock(access);
  unsetenv(name);
#endif
}

// Lavapipe reads its width once, when it is loaded: then another program of this process has chosen.
bool lavapipeIsLoaded() {
#ifdef __linux__
  const auto look = [](dl_phdr_info* library, size_t, void*) -> int {
    return std::string_view(library->dlpi_name).find("libvulkan_lvp") != std::string_view::npos;
  };
  return dl_iterate_phdr(look, nullptr) != 0;
#else
  return false;
#endif
}

constexpr const char* kWidth = "LP_NATIVE_VECTOR_WIDTH";
constexpr const char* kShaderCache = "MESA_SHADER_CACHE_DIR";
constexpr const char* kNoShaderCache = "MESA_SHADER_CACHE_DISABLE";

// What this process has set itself; a value that differs from it is the user's.
std::string ourWidth;
std::filesystem::path ourShaderCache;
bool shadersAreUnkept = false;
std::filesystem::path usersShaderCache;  // in which ours lies; empty: in the engine's cache folder

// Whether Mesa keeps what it compiles. What the user has set stays.
void keepShaders(bool kept) {
  if (kept == !shadersAreUnkept || (!kept && !environmentVariable(kNoShaderCache).empty())) return;
  setVariable(kNoShaderCache, kept ? "false" : "true");
  shadersAreUnkept = !kept;
}

}  // namespace

std::string environmentVariable(const char* name) {
  const std::lock_guard lock(access);
  const char* text = std::getenv(name);
  return text ? text : "";
}

std::filesystem::path environmentPath(const char* name) {
#ifdef _WIN32  // getenv() would give what has no letter in the code page as '?', and paths do not read the code page
  const std::lock_guard lock(access);
  const wchar_t* text = _wgetenv(std::filesystem::path(name).c_str());
  return text ? text : L"";
#else
  return environmentVariable(name);
#endif
}

std::filesystem::path userFolder(const char* name) {
  std::filesystem::path folder = environmentPath(name);
  return folder.is_absolute() ? folder : std::filesystem::path();
}

std::string processorName() {
  return brandOfProcessor() + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads";
}

uint64_t secondCacheBytes() {
#ifdef _SC_LEVEL2_CACHE_SIZE
  if (const long bytes = sysconf(_SC_LEVEL2_CACHE_SIZE); bytes > 0) return static_cast<uint64_t>(bytes);
#endif
  return DeviceTraits{}.secondCacheBytes;
}

std::filesystem::path defaultCacheFolder() {
  if (const std::filesystem::path folder = userFolder("XDG_CACHE_HOME"); !folder.empty()) return folder / "xrds";
#ifdef _WIN32
  if (const auto folder = environmentPath("LOCALAPPDATA"); !folder.empty()) return folder / "xrds";
#endif
  if (const auto home = environmentPath("HOME"); !home.empty()) return home / ".cache" / "xrds";
  return temporaryCacheFolder();
}

std::filesystem::path temporaryCacheFolder() {
  const auto folder = [] {
    const std::lock_guard lock(access);
    std::error_code failed;
    auto found = std::filesystem::temp_directory_path(failed);
    return failed ? std::filesystem::path("/tmp") : found;
  }();
#ifdef _WIN32
  return folder / "xrds-cache";
#else
  return folder / ("xrds-cache-" + std::to_string(geteuid()));
#endif
}

std::filesystem::path usersShaderCacheFolder() {
  const std::filesystem::path present = environmentPath(kShaderCache);
  return present == ourShaderCache ? usersShaderCache : present;
}

void placeShaderCache(const std::filesystem::path& folder) {
  usersShaderCache.clear();
  ourShaderCache = folder;
  setVariable(kShaderCache, ourShaderCache);
}

std::string wantedKernelFamily() { return environmentVariable("XRDS_KERNEL_FAMILY"); }

void widenCpuVectors() {
  leaveToDriverIfEmpty(kShaderCache);
  if (!environmentVariable(kWidth).empty() || !cpuHasAvx512() || lavapipeIsLoaded()) return;
  ourWidth = "512";
  setVariable(kWidth, ourWidth);
}

void separateShaderCache(const std::filesystem::path& cacheFolder) {
  const std::string width = environmentVariable(kWidth);
  const std::filesystem::path present = environmentPath(kShaderCache);
  if (present != ourShaderCache) usersShaderCache = present;
  // A user who chose both knows; a user who chose the folder alone did not expect another width in it.
  if (width.empty() || (!usersShaderCache.empty() && width != ourWidth)) return;
  // Without a folder that can be written Mesa keeps nothing; it must not read what it kept for another width either.
  const auto ours = cacheFolder.empty() ? defaultCacheFolder() : cacheFolder;
  const auto folder = (usersShaderCache.empty() ? ours : usersShaderCache) / ("mesa-w" + width);
  std::error_code failed;
  // Of a full disk it reads what is there. Where it would begin anew it maps a file that has no room: a bus error.
  const bool reads = std::filesystem::exists(folder, failed) && !std::filesystem::is_empty(folder, failed);
  keepShaders(!cacheFolder.empty() || !usersShaderCache.empty() || reads);
  if (!shadersAreUnkept) std::filesystem::create_directories(folder, failed);
  ourShaderCache = folder;
  if (ourShaderCache != present) setVariable(kShaderCache, ourShaderCache);
}

}  // namespace xrds
