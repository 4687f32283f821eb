#include "image/exr/write.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <stdexcept>
#include <vector>

#include "image/exr/attributes_stored.h"
#include "image/exr/pixel_type.h"
#include "image/pending_file.h"
#include "xrds/error.h"

namespace xrds {
namespace {

// OpenEXR finishes a file in a destructor that swallows failures; this stream remembers them until `finish`.
class StrictStream : public Imf::OStream {
 public:
  explicit StrictStream(const std::filesystem::path& path)
      : Imf::OStream(path.string().c_str()), file_(path, std::ios::binary | std::ios::trunc) {
    require(file_.is_open(), "the file cannot be created");
  }

  void write(const char* bytes, int byteSize) override {
    file_.write(bytes, byteSize);
    require(file_.good(), "the disk is full or cannot be written");
  }
  uint64_t tellp() override { return static_cast<uint64_t>(file_.tellp()); }
  void seekp(uint64_t position) override {
    file_.seekp(static_cast<std::streamoff>(position));
    require(file_.good(), "the disk is full or cannot be written");
  }

  void finish() {
    file_.close();
    require(!failed_ && file_.good(), "the disk is full or cannot be written");
  }

 private:
  void require(bool condition, const char* failure) {
    if (!condition) {
      failed_ = true;
      throw std::runtime_error(failure);
    }
  }

  std::ofstream file_;
  bool failed_ = false;
};

std::vector<std::string> channelNamesFor(const Image& image) {
  switch (image.channels) {
    case 1:
      return {"Y"};
    case 3:
      return {"R", "G", "B"};
    case 4:
      return {"R", "G", "B", "A"};
    default:
      throw Error("An image of " + std::to_string(image.channels) +
                  " channels cannot be written as OpenEXR: expected 1, 3 or 4.");
  }
}

Imath::Box2i imathBoxOf(const Box& box) { return {Imath::V2i(box.minX, box.minY), Imath::V2i(box.maxX, box.maxY)}; }

// Without channels.
Imf::Header headerFor(const ExrOutput& output) {
  Imf::Header header(imathBoxOf(output.displayWindow), imathBoxOf(output.dataWindow));
  const Imf::Header& source = output.attributes.stored().header;
  for (auto entry = source.begin(); entry != source.end(); ++entry) {
    if (describesPicture(entry.name()) && !output.texts.contains(entry.name())) {
      header.insert(entry.name(), entry.attribute());
    }
  }
  for (const auto& [name, text] : output.texts) {
    header.insert(name, Imf::StringAttribute(text));
  }
  header.compression() = Imf::ZIP_COMPRESSION;
  header.lineOrder() = Imf::INCREASING_Y;
  return header;
}

Imf::Header headerFor(const Image& image, const ExrOutput& output) {
  Imf::Header header = headerFor(output);
  for (const std::string& name : channelNamesFor(image)) {
    header.channels().insert(name, Imf::Channel(output.pixelType == ExrPixelType::kHalf ? Imf::HALF : Imf::FLOAT));
  }
  return header;
}

Imf::Header headerFor(std::span<const ExrPlane> planes, const ExrOutput& output) {
  Imf::Header header = headerFor(output);
  for (const ExrAttributes& attributes : output.layerAttributes) {
    const Imf::Header& source = attributes.stored().header;
    for (auto entry = source.begin(); entry != source.end(); ++entry)
      if (describesLayers(entry.name())) header.insert(entry.name(), entry.attribute());
  }
  for (const ExrPlane& plane : planes) header.channels().insert(plane.name, Imf::Channel(imfTypeOf(plane.type)));
  return header;
}

void writePlanes(Imf::OutputFile& file, std::span<const ExrPlane> planes, const Box& box) {
  Imf::FrameBuffer buffer;
  for (const ExrPlane& plane : planes)
    buffer.insert(
        plane.name,
        Imf::Slice::Make(imfTypeOf(plane.type), plane.bytes.data(), Imath::V2i(box.minX, box.minY), box.width(),
                         box.height(), byteSize(plane.type), byteSize(plane.type) * static_cast<size_t>(box.width())));
  file.setFrameBuffer(buffer);
  file.writePixels(static_cast<int>(box.height()));
}

// Writes a file as a whole or not at all.
template <class Write>
void writeWhole(const std::filesystem::path& path, const Imf::Header& header, const Write& write) {
  PendingFile pending(path);
  try {
    StrictStream stream(pending.temporaryPath());
    {
      Imf::OutputFile file(stream, header);
      write(file);
    }
    stream.finish();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& reason) {
    throw Error("Cannot write '" + path.string() + "': " + reason.what() +
                "; check the folder's permissions and the free space of its disk.");
  }
  pending.commit();
}

// Converts band by band: half precision needs no second image, and every band has blocks enough for all threads.
void writeHalfRows(Imf::OutputFile& file, const Image& image, const Box& box, const std::vector<std::string>& names) {
  constexpr int kBandHeight = 256;
  const size_t rowLength = static_cast<size_t>(image.width) * names.size();
  std::vector<half> band;
  for (int firstRow = 0; firstRow < image.height; firstRow += kBandHeight) {
    const int rowCount = std::min(kBandHeight, image.height - firstRow);
    band.resize(static_cast<size_t>(rowCount) * rowLength);
    const float* source = &image.pixels[image.index(0, firstRow)];
    std::transform(source, source + band.size(), band.begin(), [](float value) {
      constexpr auto kLargest = static_cast<float>(HALF_MAX);
      return half(std::isfinite(value) ? std::clamp(value, -kLargest, kLargest) : value);
    });
    Imf::FrameBuffer buffer;
    for (size_t c = 0; c < names.size(); ++c) {
      buffer.insert(names[c],
                    Imf::Slice::Make(Imf::HALF, &band[c], Imath::V2i(box.minX, box.minY + firstRow), image.width,
                                     rowCount, names.size() * sizeof(half), rowLength * sizeof(half)));
    }
    file.setFrameBuffer(buffer);
    file.writePixels(rowCount);
  }
}

void writeFloatRows(Imf::OutputFile& file, const Image& image, const Box& box, const std::vector<std::string>& names) {
  Imf::FrameBuffer buffer;
  const size_t pixelStride = names.size() * sizeof(float);
  for (size_t c = 0; c < names.size(); ++c) {
    buffer.insert(names[c],
                  Imf::Slice::Make(Imf::FLOAT, &image.pixels[c], Imath::V2i(box.minX, box.minY), image.width,
                                   image.height, pixelStride, pixelStride * static_cast<size_t>(image.width)));
  }
  file.setFrameBuffer(buffer);
  file.writePixels(image.height);
}

void checkFits(const std::filesystem::path& path, const Image& image, const ExrOutput& output) {
  const std::string start = "Cannot write '" + path.string() + "': ";
  if (output.dataWindow.width() != image.width || output.dataWindow.height() != image.height || image.pixels.empty()) {
    throw Error(start + "expected an image that fills its data window, found " + std::to_string(image.width) + " x " +
                std::to_string(image.height) + " pixels for " + toString(output.dataWindow) + ".");
  }
  if (output.pixelType == ExrPixelType::kUint) {
    throw Error(start + "expected half or float pixels, found whole numbers.");
  }
}

}  // namespace

ExrOutput scaledOutput(const ExrPart& source, int scale) {
  ExrOutput output;
  output.dataWindow = scaledBox(source.dataWindow, scale);
  output.displayWindow = scaledBox(source.displayWindow, scale);
  output.attributes = source.attributes;
  return output;
}

void writeExr(const std::filesystem::path& path, const Image& image, const ExrOutput& output) {
  checkFits(path, image, output);
  writeWhole(path, headerFor(image, output), [&](Imf::OutputFile& file) {
    const std::vector<std::string> names = channelNamesFor(image);
    if (output.pixelType == ExrPixelType::kHalf) {
      writeHalfRows(file, image, output.dataWindow, names);
    } else {
      writeFloatRows(file, image, output.dataWindow, names);
    }
  });
}

void writeExr(const std::filesystem::path& path, std::span<const ExrPlane> planes, const ExrOutput& output) {
  const size_t pixels =
      static_cast<size_t>(output.dataWindow.width()) * static_cast<size_t>(output.dataWindow.height());
  std::set<std::string> names;
  for (const ExrPlane& plane : planes) {
    if (plane.bytes.size() != pixels * byteSize(plane.type))
      throw Error("Cannot write '" + path.string() + "': channel '" + printable(plane.name) +
                  "' does not fill the data window " + toString(output.dataWindow) + ".");
    if (!names.insert(plane.name).second)
      throw Error("Cannot write '" + path.string() + "': two channels have the name '" + printable(plane.name) + "'.");
  }
  writeWhole(path, headerFor(planes, output),
             [&](Imf::OutputFile& file) { writePlanes(file, planes, output.dataWindow); });
}

}  // namespace xrds
