#include "app/skip_map.h"

#include "image/png_write.h"

namespace xrds {

std::array<float, 4> skipTint(SkipMap::Window window) {
  constexpr float kDimmed = 0.3F, kTint = 0.15F;  // linear
  switch (window) {
    case SkipMap::Window::interpolated:
      return {kTint, 0, 0, kDimmed};
    case SkipMap::Window::kept:
      return {0, 0, kTint, kDimmed};
    case SkipMap::Window::computed:
      break;
  }
  return {0, 0, 0, 1};
}

void writeSkipMap(const std::filesystem::path& path, const Image& result, const SkipMap& map) {
  Image shown = result;
  for (int y = 0; y < shown.height; ++y)
    for (int x = 0; x < shown.width; ++x) {
      const size_t column = static_cast<size_t>(x) / map.side, row = static_cast<size_t>(y) / map.side;
      const std::array<float, 4> tint = skipTint(map.windows[row * map.columns + column]);
      for (int c = 0; c < 3; ++c) shown.at(x, y, c) = tint[3] * shown.at(x, y, c) + tint[static_cast<size_t>(c)];
    }
  writePng(path, shown);
}

}  // namespace xrds
