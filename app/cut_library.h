#pragma once

#include <filesystem>

namespace xrds {

/// Of a library and its parts beside it ("libX_core.so.2" of "libX.so.2") a file that ends before what is loaded of it,
/// as one whose download broke off; empty if there is none, or the library is named without its folder. The system ends
/// a process that loads such a file. Knows the ELF files of 64-bit Linux; others count as whole.
std::filesystem::path cutLibrary(const std::filesystem::path& library);

}  // namespace xrds
