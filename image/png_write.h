#pragma once

#include <filesystem>

#include "image/image.h"

namespace xrds {

/// Writes linear radiance as an 8-bit PNG: times `exposure`, clamped to [0, 1], the sRGB transfer function, rounded to
/// the nearest step; NaN becomes black. One channel is written as grey, three as RGB, four as RGB with straight alpha,
/// to which neither exposure nor transfer applies. The file appears whole or not at all. Throws Error when the image is
/// empty or has another number of channels, or when the file cannot be written.
void writePng(const std::filesystem::path& path, const Image& image, float exposure = 1.0F);

}  // namespace xrds
