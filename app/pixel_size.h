#pragma once

#include <cstdint>
#include <string>

namespace xrds {

/// Pixels of a picture.
struct PixelSize {
  uint32_t width = 0, height = 0;
  bool operator==(const PixelSize&) const = default;
};

/// Of "1920x1080", which an option takes, each side from `least` to `most`. Throws Failure with ExitCode::usage if the
/// text is none.
PixelSize parsePixelSize(const std::string& text, const std::string& option, uint32_t least, uint32_t most);

/// What --size of a command takes: the size of the output.
inline PixelSize parseOutputSize(const std::string& text) { return parsePixelSize(text, "--size", 1, 99999); }

}  // namespace xrds
