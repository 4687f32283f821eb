#include "app/cut_library.h"

#include <system_error>

#ifdef __linux__
#include <elf.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#endif

namespace xrds {
namespace fs = std::filesystem;

#ifdef __linux__
namespace {

bool isCut(const fs::path& file) {
  std::error_code error;
  const uint64_t size = fs::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  Elf64_Ehdr head{};
  if (error || !stream.read(reinterpret_cast<char*>(&head), sizeof head) ||
      std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0 || head.e_ident[EI_CLASS] != ELFCLASS64 ||
      head.e_phentsize != sizeof(Elf64_Phdr))
    return false;
  stream.seekg(static_cast<std::streamoff>(head.e_phoff));
  for (int i = 0; i < head.e_phnum; ++i) {
    Elf64_Phdr segment{};
    if (!stream.read(reinterpret_cast<char*>(&segment), sizeof segment)) return true;
    if (segment.p_type == PT_LOAD && (segment.p_offset > size || segment.p_filesz > size - segment.p_offset))
      return true;
  }
  return false;
}

}  // namespace

fs::path cutLibrary(const fs::path& library) {
  std::error_code ignored;
  if (!library.has_parent_path() || !fs::is_regular_file(library, ignored)) return {};
  if (isCut(library)) return library;
  const std::string name = library.filename().string(), stem = name.substr(0, name.find('.'));
  for (const auto& entry : fs::directory_iterator(library.parent_path(), ignored))
    if (entry.path().filename().string().starts_with(stem + "_") && entry.is_regular_file(ignored) &&
        isCut(entry.path()))
      return entry.path();
  return {};
}
#else
fs::path cutLibrary(const fs::path&) { return {}; }
#endif

}  // namespace xrds
