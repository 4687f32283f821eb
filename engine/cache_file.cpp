#include "engine/cache_file.h"

#include <array>
#include <cstring>
#include <fstream>
#include <random>

namespace xrds {
namespace {

struct Header {
  std::array<char, 8> magic{'x', 'r', 'd', 's', 'p', 'c', '0', '1'};
  uint64_t byteSize = 0;
  uint64_t hash = 0;  // of key and content
};

constexpr uint64_t kLargestCache = uint64_t{1} << 30;

// FNV-1a, 64 bits.
uint64_t hashOf(std::string_view key, std::span<const std::byte> content) {
  uint64_t hash = 0xcbf29ce484222325u;
  const auto mix = [&hash](uint8_t byte) { hash = (hash ^ byte) * 0x100000001b3u; };
  for (const char letter : key) mix(static_cast<uint8_t>(letter));
  for (const std::byte byte : content) mix(static_cast<uint8_t>(byte));
  return hash;
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
  if (!in || hashOf(key, content) != header.hash) return {};
  return content;
}

bool writeCacheFile(const std::filesystem::path& file, std::string_view key, std::span<const std::byte> content) {
  std::error_code failed;
  std::filesystem::create_directories(file.parent_path(), failed);
  auto pending = file;
  pending += std::to_string(std::random_device{}());
  {
    std::ofstream out(pending, std::ios::binary);
    const Header header{.byteSize = content.size(), .hash = hashOf(key, content)};
    out.write(reinterpret_cast<const char*>(&header), sizeof(header));
    out.write(reinterpret_cast<const char*>(content.data()), static_cast<std::streamsize>(content.size()));
    out.close();
    if (!out) failed = std::make_error_code(std::errc::io_error);
  }
  if (!failed) std::filesystem::rename(pending, file, failed);
  if (!failed) return true;
  std::error_code ignored;
  std::filesystem::remove(pending, ignored);
  return false;
}

}  // namespace xrds
