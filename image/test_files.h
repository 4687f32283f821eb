#pragma once

#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfPixelType.h>

#include <filesystem>
#include <string>
#include <vector>

#include "image/box.h"

namespace xrds::test {

/// One part of a fixture file: its channels by full name, all of one type, with values that `fixtureValue` gives.
struct FixturePart {
  std::string name;
  Box dataWindow;
  Box displayWindow;
  std::vector<std::string> channels = {};
  Imf::PixelType type = Imf::FLOAT;
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  int tileSize = 0;  ///< 0 for scan lines.
  std::string view = {};
};

/// What a fixture stores in channel `c` (counted in the order given) at absolute position (x, y); exact in half.
float fixtureValue(int x, int y, size_t c);

/// A header for one part, to which a test may add attributes.
Imf::Header fixtureHeader(const FixturePart& part);

/// Writes a file with one part or several by OpenEXR itself; `headers` belong to `parts` and default to fixtureHeader.
void writeFixture(const std::filesystem::path& path, const std::vector<FixturePart>& parts,
                  std::vector<Imf::Header> headers = {});

std::string readBytes(const std::filesystem::path& path);
void writeBytes(const std::filesystem::path& path, const std::string& bytes);

}  // namespace xrds::test
