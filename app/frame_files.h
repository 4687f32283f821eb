#pragma once

#include <filesystem>
#include <vector>

#include "image/layers/aov.h"

namespace xrds {

/// The EXR files of one frame; `auxiliary` is empty if its layers are in `colour` or there are none.
struct FrameFiles {
  std::filesystem::path colour, auxiliary, reference;
  bool operator==(const FrameFiles&) const = default;
};

/// Tells which of some files are the colour (the smallest), the auxiliary images (it has an albedo) and the reference
/// (what is left), by their headers. Of several that could be the same one the first is taken. Throws Error if there
/// are none.
FrameFiles sortHeaders(const std::vector<ExrFile>& headers);
/// The same of files. Throws Error also if one cannot be read.
FrameFiles sortFiles(const std::vector<std::filesystem::path>& files);

/// Tells colour and auxiliary images apart, in whichever order they are given: the colour is the smaller one or, of
/// equal ones, that without an albedo. Where that does not tell, they stay in their order. Throws Error if one cannot
/// be read.
FrameFiles sortPair(const std::filesystem::path& first, const std::filesystem::path& second);

}  // namespace xrds
