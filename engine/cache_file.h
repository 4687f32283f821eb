#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace xrds {

/// The content of a cache file; empty unless it is whole, undamaged and was written for the same key.
std::vector<std::byte> readCacheFile(const std::filesystem::path& file, std::string_view key);

/// Replaces the file in one step, so that a reader sees the old or the new one. Returns false if that fails.
bool writeCacheFile(const std::filesystem::path& file, std::string_view key, std::span<const std::byte> content);

}  // namespace xrds
