#pragma once

#include <filesystem>

#include "image/image.h"
#include "xrds/skip.h"

namespace xrds {

/// Writes the picture as a PNG in which the windows that were interpolated are tinted red and half as bright, those
/// that were kept blue. Throws Error as writePng does.
void writeSkipMap(const std::filesystem::path& path, const Image& result, const SkipMap& map);

}  // namespace xrds
