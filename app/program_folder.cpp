#include "app/program_folder.h"

#include <string>
#if defined(_WIN32)
#include <windows.h>
#elif defined(__APPLE__)
#include <mach-o/dyld.h>

#include <cstdint>
#endif

namespace xrds {
namespace fs = std::filesystem;

fs::path programFolder() {
  std::error_code error;
#if defined(_WIN32)
  std::wstring name(MAX_PATH, L'\0');
  DWORD size = GetModuleFileNameW(nullptr, name.data(), static_cast<DWORD>(name.size()));
  while (size == name.size()) {  // cut off
    name.resize(2 * name.size());
    size = GetModuleFileNameW(nullptr, name.data(), static_cast<DWORD>(name.size()));
  }
  const fs::path program = name.substr(0, size);
#elif defined(__APPLE__)
  uint32_t size = 0;
  _NSGetExecutablePath(nullptr, &size);  // with the final zero
  std::string name(size, '\0');
  if (_NSGetExecutablePath(name.data(), &size) != 0) return {};
  const fs::path program = fs::canonical(name.c_str(), error);
#else
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
#endif
  return error ? fs::path() : program.parent_path();
}

}  // namespace xrds
