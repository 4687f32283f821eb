#include "engine/cache_file.h"

#include <array>
#include <fstream>

#include "engine/bytes.h"
#include "engine/replace_file.h"

namespace xrds {
namespace {

struct Header {
  std::array<char, 8> magic{'x', 'r', 'd', 's', 'p', 'c', '0', '1'};
  uint64_t byteSize = 0;
  uint64_t hash = 0;  // of key and content
};

constexpr uint64_t kLargestCache = uint64_t{1} << 30;

uint64_t keyedHash(std::string_view key, std::span<const std::byte> content) {
  return hashOf(content, hashOf(std::as_bytes(std::span(key))));
}

}  // namespace

std::vector<std::byte> readCacheFile(const std::filesystem::path& file, std::string_view key) {
  std::ifstream in(file, std::ios::binary);
  Header header;
  in.read(reinterpret_cast<char*>(&header), sizeof(header));
  if (!in || header.magic != Header{}.magic || header.byteSize > kLargestCache) return {};
  std::error_code failed;
  if (std::filesystem::file_size(file, failed) != sizeof(header) + header.byteSize || failed) return {};
  std::vector<std::byte> content(header.byteSize);
  in.read(reinterpret_cast<char*>(content.data()), static_cast<std::streamsize>(content.size()));
  if (!in || keyedHash(key, content) != header.hash) return {};
  return content;
}

bool writeCacheFile(const std::filesystem::path& file, std::string_view key, std::span<const std::byte> content) {
  std::error_code failed;
  std::filesystem::create_directories(file.parent_path(), failed);
  const Header header{.byteSize = content.size(), .hash = keyedHash(key, content)};
  return replaceFile(file, {std::as_bytes(std::span(&header, 1)), content});
}

}  // namespace xrds
