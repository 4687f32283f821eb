#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace xrds {

/// The path that a text names. Text is UTF-8 on every system, while on Windows std::filesystem::path(text) reads other
/// encodings.
inline std::filesystem::path pathOf(std::string_view text) { return std::u8string(text.begin(), text.end()); }

}  // namespace xrds
