#pragma once

#include <cstdint>
#include <string>

namespace xrds {

/// Pixels of a picture to make.
struct OutputSize {
  uint32_t width = 0, height = 0;
};

/// Of "1920x1080", what --size takes. Throws Failure with ExitCode::usage if the text is none.
OutputSize parseOutputSize(const std::string& text);

}  // namespace xrds
