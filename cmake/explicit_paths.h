// Part of the precompiled headers of programs that get text from their users: a path is made of text by pathOf() alone
// (xrds/path_text.h), as on Windows std::filesystem::path(text) reads no UTF-8. Literals are ASCII and may stay. Of
// views of text the check tells nowhere, of text that is a temporary on Windows alone. The names within are those of
// GCC 12's standard library.
#pragma once

#include <filesystem>
#include <string>

#if defined(_GLIBCXX_RELEASE) && _GLIBCXX_RELEASE == 12
template <>
inline constexpr bool std::filesystem::__detail::__is_path_src<std::string> = false;
template <>
inline constexpr bool std::filesystem::__detail::__is_path_src<const char*> = false;
template <>
inline constexpr bool std::filesystem::__detail::__is_path_src<char*> = false;
#endif
