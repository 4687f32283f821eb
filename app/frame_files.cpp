#include "app/frame_files.h"

#include <algorithm>

#include "xrds/error.h"

namespace xrds {
namespace {

namespace fs = std::filesystem;

int widthOf(const ExrFile& file) {
  int width = 0;
  for (const ExrPart& part : file.parts) width = std::max(width, static_cast<int>(part.displayWindow.width()));
  return width;
}

}  // namespace

FrameFiles sortHeaders(const std::vector<ExrFile>& headers) {
  if (headers.empty()) throw Error("There is no EXR file to show.");
  FrameFiles sorted;
  const auto smallest = std::min_element(headers.begin(), headers.end(),
                                         [](const auto& a, const auto& b) { return widthOf(a) < widthOf(b); });
  sorted.colour = smallest->path;
  int fullWidth = 0;
  for (const ExrFile& file : headers)
    if (file.path != sorted.colour && sorted.auxiliary.empty() && hasAov(file, AovRole::kAlbedo)) {
      sorted.auxiliary = file.path;
      fullWidth = widthOf(file);
    }
  // Older colours of a folder are no references.
  const auto isReference = [&](const ExrFile& file) {
    if (file.path == sorted.colour || hasAov(file, AovRole::kAlbedo)) return false;
    return fullWidth > 0 ? widthOf(file) == fullWidth : widthOf(file) > widthOf(*smallest);
  };
  const auto reference = std::find_if(headers.begin(), headers.end(), isReference);
  if (reference != headers.end()) sorted.reference = reference->path;
  return sorted;
}

FrameFiles sortFiles(const std::vector<fs::path>& files) {
  std::vector<ExrFile> headers;
  headers.reserve(files.size());
  for (const fs::path& file : files) headers.push_back(readExrHeader(file));
  return sortHeaders(headers);
}

FrameFiles sortPair(const fs::path& first, const fs::path& second) {
  const ExrFile a = readExrHeader(first), b = readExrHeader(second);
  const bool aHas = hasAov(a, AovRole::kAlbedo), bHas = hasAov(b, AovRole::kAlbedo);
  const bool swapped = widthOf(a) == widthOf(b) ? aHas && !bHas : widthOf(a) > widthOf(b) && (aHas || !bHas);
  return swapped ? FrameFiles{second, first, {}} : FrameFiles{first, second, {}};
}

}  // namespace xrds
