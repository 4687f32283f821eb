#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "image/box.h"
#include "image/exr/attributes.h"
#include "image/exr/planes.h"
#include "image/image.h"

namespace xrds {

/// Everything that an EXR file is to say beside its pixels.
struct ExrOutput {
  Box dataWindow;
  Box displayWindow;
  ExrAttributes attributes;                       ///< Passed on from the file that the image was made of.
  std::vector<ExrAttributes> layerAttributes{};   ///< Of the parts that layers are copied from: what speaks of them.
  std::map<std::string, std::string> texts;       ///< Further string attributes, such as "xrds:version".
  ExrPixelType pixelType = ExrPixelType::kFloat;  ///< kFloat or kHalf.
};

/// The output that belongs to a frame upscaled from `source`: its attributes, and both of its windows scaled exactly.
/// Throws Error when the windows do not fit in 32 bits.
ExrOutput scaledOutput(const ExrPart& source, int scale);

/// Writes an image of one (Y), three (R, G, B) or four (R, G, B, A) channels as one flat scan-line part with ZIP
/// compression. The file appears whole or not at all: it is written beside `path` under a temporary name and renamed.
/// With kHalf, finite values beyond the range of half become its largest number. Throws Error when the image does not
/// fill the data window, the pixel type is kUint, the folder cannot be written or the disk is full.
void writeExr(const std::filesystem::path& path, const Image& image, const ExrOutput& output);

/// Writes planes as the channels of one flat scan-line part, each in its own type, in the same way. Throws Error also
/// when two planes have one name, or one does not fill the data window.
void writeExr(const std::filesystem::path& path, std::span<const ExrPlane> planes, const ExrOutput& output);

}  // namespace xrds
