#include "api/model_folders.h"

#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#endif

#include "engine/environment.h"
#include "xrds/path_text.h"

namespace xrds {
namespace fs = std::filesystem;
namespace {

// The folder of the file that holds this code; empty where the system does not tell.
fs::path ownFolder() {
  std::error_code error;
#if defined(_WIN32)
  HMODULE module = nullptr;
  std::wstring path(MAX_PATH, L'\0');
  constexpr DWORD kFlags = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
  if (!GetModuleHandleExW(kFlags, reinterpret_cast<LPCWSTR>(&ownFolder), &module)) return {};
  DWORD size = GetModuleFileNameW(module, path.data(), static_cast<DWORD>(path.size()));
  while (size == path.size()) {  // cut off
    path.resize(2 * path.size());
    size = GetModuleFileNameW(module, path.data(), static_cast<DWORD>(path.size()));
  }
  if (size == 0) return {};
  const fs::path file = path.substr(0, size);
#else
  Dl_info found{};
  if (dladdr(reinterpret_cast<const void*>(&ownFolder), &found) == 0 || !found.dli_fname) return {};
  fs::path file = found.dli_fname;
#if defined(__linux__)  // of the program itself this is the word that it was called by
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error && program.filename() == file.filename()) file = program;
#endif
#endif
  const fs::path real = fs::canonical(file, error);
  return error ? fs::path() : real.parent_path();
}

}  // namespace

std::vector<fs::path> foldersOfModels() {
  std::vector<fs::path> folders;
  if (fs::path folder = environmentPath("XRDS_MODELS"); !folder.empty()) folders.push_back(std::move(folder));
  if (const fs::path own = ownFolder(); !own.empty())
    for (const char* up : {".", "..", "../.."}) folders.push_back((own / up / "share/xrds/models").lexically_normal());
#ifdef XRDS_MODEL_FOLDER
  folders.emplace_back(XRDS_MODEL_FOLDER);
#endif
  return folders;
}

fs::path modelFile(const std::string& name) {
  std::error_code ignored;
  for (const fs::path& folder : foldersOfModels())
    if (fs::path file = folder / pathOf(name + ".safetensors"); fs::exists(file, ignored)) return file;
  return {};
}

}  // namespace xrds
