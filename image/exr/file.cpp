#include "image/exr/file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTileDescription.h>

#include <algorithm>
#include <sstream>
#include <system_error>

#include "image/exr/attributes_stored.h"
#include "image/exr/open.h"
#include "image/exr/pixel_type.h"

namespace xrds {
namespace {

constexpr int64_t kMaxBlockByteSize = int64_t{1} << 30;
// What a block may take whatever the file's size, and per byte of the file: no deflated byte becomes more than 1032.
constexpr int64_t kAnyBlockByteSize = int64_t{1} << 26;
constexpr int64_t kBytesPerFileByte = 1032;

Box boxOf(const Imath::Box2i& box) { return {box.min.x, box.min.y, box.max.x, box.max.y}; }

std::vector<ExrLayer> layersOf(const Imf::ChannelList& channels) {
  std::vector<ExrLayer> layers;
  for (auto entry = channels.begin(); entry != channels.end(); ++entry) {
    ExrChannel channel;
    channel.name = entry.name();
    channel.type = pixelTypeOf(entry.channel().type);
    channel.xSampling = entry.channel().xSampling;
    channel.ySampling = entry.channel().ySampling;
    const size_t dot = channel.name.rfind('.');
    const std::string layerName = dot == std::string::npos ? "" : channel.name.substr(0, dot);
    channel.suffix = dot == std::string::npos ? channel.name : channel.name.substr(dot + 1);
    auto layer = std::find_if(layers.begin(), layers.end(), [&](const ExrLayer& l) { return l.name == layerName; });
    if (layer == layers.end()) {
      layer = layers.insert(layers.end(), ExrLayer{layerName, {}});
    }
    layer->channels.push_back(std::move(channel));
  }
  return layers;
}

// How many rows OpenEXR decodes at once, which bounds the buffers that it allocates for a part.
int64_t rowsPerBlock(const Imf::Header& header) {
  if (header.hasTileDescription()) {
    return header.tileDescription().ySize;
  }
  switch (header.compression()) {
    case Imf::NO_COMPRESSION:
    case Imf::RLE_COMPRESSION:
    case Imf::ZIPS_COMPRESSION:
      return 1;
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return 32;
  }
}

// The blocks that OpenEXR allocates as it opens a part, so that few bytes cannot ask for much memory.
void checkBlocks(const ExrFile& file, const Imf::Header& header, int64_t width) {
  const int64_t blockWidth =
      header.hasTileDescription() ? std::max<int64_t>(width, header.tileDescription().xSize) : width;
  int64_t pixelByteSize = 0;
  for (auto entry = header.channels().begin(); entry != header.channels().end(); ++entry) {
    pixelByteSize += entry.channel().type == Imf::HALF ? 2 : 4;
  }
  std::error_code failure;
  const auto fileByteSize = static_cast<double>(std::filesystem::file_size(file.path, failure));
  const double allowed = std::min(
      static_cast<double>(kMaxBlockByteSize),
      static_cast<double>(kAnyBlockByteSize) + (failure ? 0 : static_cast<double>(kBytesPerFileByte) * fileByteSize));
  const double blockByteSize =
      static_cast<double>(blockWidth) * static_cast<double>(rowsPerBlock(header)) * static_cast<double>(pixelByteSize);
  if (blockByteSize > allowed) {
    throw Error("Cannot read '" + file.path.string() + "': expected blocks of at most " +
                std::to_string(static_cast<int64_t>(allowed) >> 20) + " MiB, found " + std::to_string(pixelByteSize) +
                " bytes a pixel in blocks of " + std::to_string(blockWidth) + " x " +
                std::to_string(rowsPerBlock(header)) + " pixels; check that it is intact.");
  }
}

void checkSize(const ExrFile& file, const Box& box, const Imf::Header& header) {
  const int64_t width = box.width();
  const int64_t height = box.height();
  if (width < 1 || height < 1 || width > kMaxPixelCount / height) {
    throw Error("Cannot read '" + file.path.string() + "': expected at most " + std::to_string(kMaxPixelCount) +
                " pixels, found a data window of " + toString(box) + "; crop the frame or check that it is intact.");
  }
  checkBlocks(file, header, width);
}

ExrPart partOf(const ExrFile& file, const Imf::Header& header) {
  ExrPart part;
  part.name = header.hasName() ? header.name() : "";
  part.view = header.hasView() ? header.view() : "";
  part.dataWindow = boxOf(header.dataWindow());
  part.displayWindow = boxOf(header.displayWindow());
  part.deep = header.hasType() && (header.type() == Imf::DEEPSCANLINE || header.type() == Imf::DEEPTILE);
  part.tiled = header.hasTileDescription();
  part.layers = layersOf(header.channels());
  part.attributes = attributesOf(header);
  checkSize(file, part.dataWindow, header);
  return part;
}

std::string typeName(ExrPixelType type) {
  switch (type) {
    case ExrPixelType::kHalf:
      return "half";
    case ExrPixelType::kFloat:
      return "float";
    default:
      return "uint";
  }
}

}  // namespace

ExrFile readExrHeader(const std::filesystem::path& path) {
  return withExrErrors(path, [&] {
    ExrFile file;
    file.path = path;
    const auto input = openExr(path);
    for (int part = 0; part < input->parts(); ++part) {
      const Imf::Header& header = input->header(part);
      file.parts.push_back(partOf(file, header));
      if (part == 0 && Imf::hasMultiView(header)) {
        file.views = Imf::multiView(header);
      }
    }
    return file;
  });
}

void useExrThreads(int count) {
  if (count < 0) {
    throw Error("OpenEXR cannot use " + std::to_string(count) + " threads: expected 0 or more.");
  }
  Imf::setGlobalThreadCount(count);
}

std::string printable(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char letter) { return letter < 0x20 || letter == 0x7F; }, '?');
  return name;
}

std::string describe(const ExrFile& file) {
  std::ostringstream text;
  text << "'" << file.path.string() << "' holds";
  for (size_t number = 0; number < file.parts.size(); ++number) {
    const ExrPart& part = file.parts[number];
    for (const ExrLayer& layer : part.layers) {
      text << "\n  part " << number;
      if (!part.name.empty()) {
        text << " '" << printable(part.name) << "'";
      }
      if (!part.view.empty()) {
        text << " view '" << printable(part.view) << "'";
      }
      text << (part.deep ? " (deep), " : ", ") << part.dataWindow.width() << " x " << part.dataWindow.height() << ": "
           << (layer.name.empty() ? "(unnamed)" : printable(layer.name)) << " [";
      for (const ExrChannel& channel : layer.channels) {
        text << (&channel == &layer.channels.front() ? "" : " ") << printable(channel.suffix);
      }
      text << "] " << typeName(layer.channels.front().type);
    }
  }
  return text.str();
}

}  // namespace xrds
