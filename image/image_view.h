#pragma once

#include <cstdint>

#include "image/image.h"
#include "xrds/pixel_view.h"

namespace xrds {

/// The pixels as the library takes them.
inline PixelView viewOf(const Image& image) {
  return {image.pixels.data(), static_cast<uint32_t>(image.width), static_cast<uint32_t>(image.height),
          static_cast<uint32_t>(image.channels)};
}

}  // namespace xrds
