#pragma once

#include <array>
#include <filesystem>

#include "image/image.h"
#include "xrds/skip.h"

namespace xrds {

/// How a window is marked in a picture: light added to red, green and blue, and the factor on the picture itself.
/// Windows that were interpolated are dark and red, those that were kept dark and blue.
std::array<float, 4> skipTint(SkipMap::Window window);

/// Writes the picture with its windows marked as a PNG. Throws Error as writePng does.
void writeSkipMap(const std::filesystem::path& path, const Image& result, const SkipMap& map);

}  // namespace xrds
