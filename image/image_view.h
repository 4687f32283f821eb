#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"
#include "xrds/pixel_view.h"

namespace xrds {

/// The pixels as the library takes them.
inline PixelView viewOf(const Image& image) {
  return {image.pixels.data(), static_cast<uint32_t>(image.width), static_cast<uint32_t>(image.height),
          static_cast<uint32_t>(image.channels)};
}

/// Of each.
inline std::vector<PixelView> viewsOf(const std::vector<Image>& images) {
  std::vector<PixelView> views;
  views.reserve(images.size());
  for (const Image& image : images) views.push_back(viewOf(image));
  return views;
}

}  // namespace xrds
