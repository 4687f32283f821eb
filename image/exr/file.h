#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "image/box.h"
#include "image/exr/attributes.h"

namespace xrds {

/// How a channel stores its numbers.
enum class ExrPixelType { kHalf, kFloat, kUint };

/// One channel of a layer; `name` is the full name in the file, `suffix` what follows its last dot.
struct ExrChannel {
  std::string name;
  std::string suffix;
  ExrPixelType type = ExrPixelType::kFloat;
  int xSampling = 1;
  int ySampling = 1;
};

/// The channels of a part whose names agree up to their last dot; the layer of channels without a dot has no name.
struct ExrLayer {
  std::string name;
  std::vector<ExrChannel> channels;
};

/// One part of an EXR file: layers of one size under one header.
struct ExrPart {
  std::string name;  ///< Empty where the file gives none.
  std::string view;  ///< Empty where the file gives none.
  Box dataWindow;
  Box displayWindow;
  bool deep = false;
  bool tiled = false;
  std::vector<ExrLayer> layers;
  ExrAttributes attributes;
};

/// What the headers of an EXR file say; no pixels.
struct ExrFile {
  std::filesystem::path path;
  std::vector<std::string> views;  ///< The views that share its parts (`multiView`), the default one first.
  std::vector<ExrPart> parts;
};

/// The most pixels that one layer may have (16384 x 16384). Larger frames are refused before anything is allocated.
inline constexpr int64_t kMaxPixelCount = int64_t{1} << 28;

/// Reads the headers of an OpenEXR file: scan lines or tiles, one part or several, one layer or several. Deep parts are
/// listed but cannot be read. Throws Error when the file is absent, damaged, no OpenEXR file or larger than
/// kMaxPixelCount. Safe to call from several threads.
ExrFile readExrHeader(const std::filesystem::path& path);

/// How many threads OpenEXR may add to the caller's for packing and unpacking pixels, in the whole program; 0, with
/// which a program starts, for none. Throws Error when `count` is negative. Call it before files are read or written.
void useExrThreads(int count);

/// A name from a file as it may be shown: control characters, which could upset a terminal, become question marks.
std::string printable(std::string name);

/// What the file holds, one line a layer, with sizes and channels: for messages that must say what there is to choose.
std::string describe(const ExrFile& file);

}  // namespace xrds
