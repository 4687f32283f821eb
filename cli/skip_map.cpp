#include "cli/skip_map.h"

#include "image/png_write.h"

namespace xrds {

void writeSkipMap(const std::filesystem::path& path, const Image& result, const SkipMap& map) {
  constexpr float kDimmed = 0.3F, kTint = 0.15F;  // linear
  Image shown = result;
  for (int y = 0; y < shown.height; ++y)
    for (int x = 0; x < shown.width; ++x) {
      const size_t column = static_cast<size_t>(x) / map.side, row = static_cast<size_t>(y) / map.side;
      const SkipMap::Window window = map.windows[row * map.columns + column];
      if (window == SkipMap::Window::computed) continue;
      for (int c = 0; c < 3; ++c) shown.at(x, y, c) *= kDimmed;
      shown.at(x, y, window == SkipMap::Window::interpolated ? 0 : 2) += kTint;
    }
  writePng(path, shown);
}

}  // namespace xrds
