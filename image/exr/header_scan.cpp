#include "image/exr/header_scan.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint32_t kSeveralParts = 0x1000;  // of the version field
constexpr size_t kLongestName = 255;

std::optional<uint32_t> readWhole(std::istream& file) {
  std::array<unsigned char, 4> bytes{};
  if (!file.read(reinterpret_cast<char*>(bytes.data()), bytes.size())) {
    return std::nullopt;
  }
  return bytes[0] | uint32_t{bytes[1]} << 8U | uint32_t{bytes[2]} << 16U | uint32_t{bytes[3]} << 24U;
}

// Up to its zero byte; nothing when there is none in reach, which OpenEXR refuses in its own words.
std::optional<std::string> readName(std::istream& file) {
  std::string name;
  for (char letter = 0; name.size() <= kLongestName && file.get(letter); name += letter) {
    if (letter == 0) {
      return name;
    }
  }
  return std::nullopt;
}

// What OpenEXR reads for a type whatever size the attribute states; 0 for types of any size. Where the two differ, it
// would take the bytes behind for the next attribute.
uint32_t fixedByteSize(const std::string& type) {
  static const std::map<std::string, uint32_t> kSizes = {{"box2f", 16},
                                                         {"box2i", 16},
                                                         {"chromaticities", 32},
                                                         {"compression", 1},
                                                         {"deepImageState", 1},
                                                         {"double", 8},
                                                         {"envmap", 1},
                                                         {"float", 4},
                                                         {"int", 4},
                                                         {"keycode", 28},
                                                         {"m33d", 72},
                                                         {"lineOrder", 1},
                                                         {"m33f", 36},
                                                         {"m44d", 128},
                                                         {"m44f", 64},
                                                         {"v2d", 16},
                                                         {"rational", 8},
                                                         {"tiledesc", 9},
                                                         {"timecode", 8},
                                                         {"v2f", 8},
                                                         {"v2i", 8},
                                                         {"v3d", 24},
                                                         {"v3f", 12},
                                                         {"v3i", 12}};
  const auto found = kSizes.find(type);
  return found == kSizes.end() ? 0 : found->second;
}

// Whether the value that starts here ends at `end`, for the types whose values tell their own length: a channel list
// has names of 16 bytes each until an empty one, a preview its width and height before its pixels.
bool endsWhereItSays(std::istream& file, const std::string& type, uint64_t end) {
  if (type == "preview") {
    const uint64_t width = readWhole(file).value_or(0);
    const uint64_t height = readWhole(file).value_or(0);
    return static_cast<uint64_t>(file.tellg()) + 4 * width * height == end;
  }
  if (type != "chlist") {
    return true;
  }
  for (auto name = readName(file); name; name = readName(file)) {
    if (name->empty()) {
      return static_cast<uint64_t>(file.tellg()) == end;
    }
    file.seekg(16, std::ios::cur);
  }
  return false;
}

enum class Found { kAttributes, kNothing, kEnd };

// One header: name, type, size and value of each attribute, then an empty name.
Found skipHeader(std::istream& file, uint64_t fileByteSize, const std::string& quoted) {
  bool some = false;
  for (auto name = readName(file); name; name = readName(file)) {
    if (name->empty()) {
      return some ? Found::kAttributes : Found::kNothing;
    }
    some = true;
    const auto type = readName(file);
    const auto byteSize = readWhole(file);
    if (!type || !byteSize) {
      break;
    }
    const auto start = static_cast<uint64_t>(file.tellg());
    const uint64_t left = fileByteSize - start;
    const uint32_t fixed = fixedByteSize(*type);
    if (*byteSize > left || (fixed != 0 && fixed != *byteSize)) {
      throw Error("Cannot read " + quoted + ": expected a complete OpenEXR image, found an attribute of " +
                  std::to_string(*byteSize) + " bytes where " + std::to_string(fixed != 0 ? fixed : left) +
                  (fixed != 0 ? " make one" : " are left") + "; render or copy it again.");
    }
    if (!endsWhereItSays(file, *type, start + *byteSize)) {
      throw Error("Cannot read " + quoted + ": expected a complete OpenEXR image, found a " + *type +
                  " that does not fill its " + std::to_string(*byteSize) + " bytes; render or copy it again.");
    }
    file.clear();
    file.seekg(static_cast<std::streamoff>(start + *byteSize));
  }
  return Found::kEnd;
}

}  // namespace

void requireAttributesInFile(const std::filesystem::path& path) {
  std::error_code failure;
  const uint64_t fileByteSize = std::filesystem::file_size(path, failure);
  std::ifstream file(path, std::ios::binary);
  file.seekg(4);
  const auto version = readWhole(file);
  if (failure || !version) {
    return;
  }
  const std::string quoted = "'" + path.string() + "'";
  const bool several = (*version & kSeveralParts) != 0;
  while (skipHeader(file, fileByteSize, quoted) == Found::kAttributes && several) {
  }
}

}  // namespace xrds
