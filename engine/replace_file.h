#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <span>

namespace xrds {

/// Replaces the file by the pieces, one behind the other, in one step, so that a reader sees the old or the new one.
/// Returns false if that fails; then nothing is left behind.
bool replaceFile(const std::filesystem::path& file, std::initializer_list<std::span<const std::byte>> pieces);

}  // namespace xrds
