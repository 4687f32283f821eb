#pragma once

#include <filesystem>

namespace xrds {

/// Prints the layers of an EXR file and which of them `xrds upscale` takes for colour, albedo, normal and depth where
/// none is named. Throws Failure if it cannot be read.
void printLayers(const std::filesystem::path& path);

}  // namespace xrds
