#pragma once

#include <cstdint>
#include <string>

namespace xrds {

/// Bytes of a text such as "256M": a number with K, M, G or T for powers of 1000, or KiB, MiB, GiB or TiB for those of
/// 1024. 0 for an empty text, and for one that is no such number.
uint64_t parseBytes(const std::string& text);

/// What is wrong with the text of an option; empty if it is a number of bytes.
std::string validBytes(const std::string& text);

}  // namespace xrds
