#include "image/test_files.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputPart.h>

#include <fstream>
#include <iterator>

namespace xrds::test {
namespace {

// The pixels of one channel in the type of the file.
struct Plane {
  std::vector<half> halves;
  std::vector<float> floats;
  std::vector<unsigned> wholes;
};

template <typename Value>
Imf::Slice fill(std::vector<Value>& values, const FixturePart& part, size_t channel) {
  const Box& w = part.dataWindow;
  values.reserve(static_cast<size_t>(w.width() * w.height()));
  for (int y = w.minY; y <= w.maxY; ++y) {
    for (int x = w.minX; x <= w.maxX; ++x) {
      values.push_back(static_cast<Value>(fixtureValue(x, y, channel)));
    }
  }
  return Imf::Slice::Make(part.type, values.data(), Imath::V2i(w.minX, w.minY), w.width(), w.height());
}

Imf::Slice fill(Plane& plane, const FixturePart& part, size_t channel) {
  switch (part.type) {
    case Imf::HALF:
      return fill(plane.halves, part, channel);
    case Imf::FLOAT:
      return fill(plane.floats, part, channel);
    default:
      return fill(plane.wholes, part, channel);
  }
}

void writePart(Imf::MultiPartOutputFile& file, int number, const FixturePart& part) {
  std::vector<Plane> planes(part.channels.size());
  Imf::FrameBuffer buffer;
  for (size_t c = 0; c < planes.size(); ++c) {
    buffer.insert(part.channels[c], fill(planes[c], part, c));
  }
  if (part.tileSize > 0) {
    Imf::TiledOutputPart output(file, number);
    output.setFrameBuffer(buffer);
    output.writeTiles(0, output.numXTiles() - 1, 0, output.numYTiles() - 1);
  } else {
    Imf::OutputPart output(file, number);
    output.setFrameBuffer(buffer);
    output.writePixels(static_cast<int>(part.dataWindow.height()));
  }
}

}  // namespace

float fixtureValue(int x, int y, size_t c) {
  return static_cast<float>(((x & 15) * 4 + (y & 15)) * 4 + static_cast<int>(c & 3U)) / 8.0F;
}

Imf::Header fixtureHeader(const FixturePart& part) {
  const auto box = [](const Box& w) { return Imath::Box2i({w.minX, w.minY}, {w.maxX, w.maxY}); };
  Imf::Header header(box(part.displayWindow), box(part.dataWindow));
  header.compression() = part.compression;
  header.setType(part.tileSize > 0 ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
  if (!part.name.empty()) {
    header.setName(part.name);
  }
  if (!part.view.empty()) {
    header.setView(part.view);
  }
  if (part.tileSize > 0) {
    header.setTileDescription(Imf::TileDescription(static_cast<unsigned>(part.tileSize),
                                                   static_cast<unsigned>(part.tileSize), Imf::ONE_LEVEL));
  }
  for (const std::string& name : part.channels) {
    header.channels().insert(name, Imf::Channel(part.type));
  }
  return header;
}

void writeFixture(const std::filesystem::path& path, const std::vector<FixturePart>& parts,
                  std::vector<Imf::Header> headers) {
  for (size_t number = headers.size(); number < parts.size(); ++number) {
    headers.push_back(fixtureHeader(parts[number]));
  }
  std::filesystem::remove(path);  // built with MinGW, OpenEXR leaves the end of a longer one
  Imf::MultiPartOutputFile file(path.string().c_str(), headers.data(), static_cast<int>(headers.size()));
  for (size_t number = 0; number < parts.size(); ++number) {
    writePart(file, static_cast<int>(number), parts[number]);
  }
}

std::string readBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void writeBytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace xrds::test
