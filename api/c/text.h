#pragma once

#include <algorithm>
#include <cstring>
#include <string>

namespace xrds::c {

/// Fills a field with as much of a text as fits, and its final zero.
template <size_t N>
void setText(char (&field)[N], const std::string& text) {
  const size_t length = std::min(text.size(), N - 1);
  std::memcpy(field, text.data(), length);
  field[length] = 0;
}

}  // namespace xrds::c
