#include "engine/replace_file.h"

#include <fstream>
#include <random>
#include <string>
#include <system_error>

namespace xrds {

bool replaceFile(const std::filesystem::path& file, std::initializer_list<std::span<const std::byte>> pieces) {
  auto pending = file;
  pending += std::to_string(std::random_device{}());
  std::ofstream out(pending, std::ios::binary);
  for (const auto piece : pieces)
    out.write(reinterpret_cast<const char*>(piece.data()), static_cast<std::streamsize>(piece.size()));
  out.close();
  std::error_code failed;
  if (out) std::filesystem::rename(pending, file, failed);
  if (out && !failed) return true;
  std::filesystem::remove(pending, failed);
  return false;
}

}  // namespace xrds
