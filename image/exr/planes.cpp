#include "image/exr/planes.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "image/exr/open.h"
#include "image/exr/pixel_type.h"

namespace xrds {
namespace {

// Rows of one channel, from `from` to `to`, where both have pixels.
void placeRows(const std::vector<std::byte>& rows, const Box& from, const Box& to, size_t numberSize,
               std::vector<std::byte>& placed) {
  const int firstX = std::max(from.minX, to.minX), lastX = std::min(from.maxX, to.maxX);
  if (firstX > lastX) return;
  for (int y = std::max(from.minY, to.minY); y <= std::min(from.maxY, to.maxY); ++y) {
    const auto at = [&](const Box& box) {
      return (static_cast<size_t>(int64_t{y} - box.minY) * static_cast<size_t>(box.width()) +
              static_cast<size_t>(int64_t{firstX} - box.minX)) *
             numberSize;
    };
    std::memcpy(&placed[at(to)], &rows[at(from)], static_cast<size_t>(int64_t{lastX} - firstX + 1) * numberSize);
  }
}

}  // namespace

size_t byteSize(ExrPixelType type) { return type == ExrPixelType::kHalf ? 2 : 4; }

std::vector<ExrPlane> readPlanes(const ExrFile& file, size_t part, const std::vector<std::string>& channelNames,
                                 const Box& window) {
  return withExrErrors(file.path, [&] {
    const auto opened = openExr(file.path);
    Imf::InputPart input(*opened, static_cast<int>(part));
    const Imath::Box2i& found = input.header().dataWindow();
    const Box box = file.parts.at(part).dataWindow;
    if (Box{found.min.x, found.min.y, found.max.x, found.max.y} != box)
      throw Error("Cannot read '" + file.path.string() + "': it changed while it was being read; try again.");
    const size_t pixels = static_cast<size_t>(box.width()) * static_cast<size_t>(box.height());
    Imf::FrameBuffer buffer;
    std::vector<ExrPlane> planes;
    planes.reserve(channelNames.size());
    for (const std::string& name : channelNames) {
      const Imf::Channel* channel = input.header().channels().findChannel(name);
      if (!channel || channel->xSampling != 1 || channel->ySampling != 1)
        throw Error("Cannot copy channel '" + name + "' of '" + file.path.string() +
                    "': " + (channel ? "it is subsampled." : "there is none of this name."));
      const ExrPixelType type = pixelTypeOf(channel->type);
      ExrPlane& plane = planes.emplace_back(ExrPlane{name, type, std::vector<std::byte>(pixels * byteSize(type))});
      buffer.insert(name,
                    Imf::Slice::Make(imfTypeOf(type), plane.bytes.data(), Imath::V2i(box.minX, box.minY), box.width(),
                                     box.height(), byteSize(type), byteSize(type) * static_cast<size_t>(box.width())));
    }
    input.setFrameBuffer(buffer);
    input.readPixels(box.minY, box.maxY);
    if (box == window) return planes;
    for (ExrPlane& plane : planes) {
      std::vector<std::byte> placed(static_cast<size_t>(window.width()) * static_cast<size_t>(window.height()) *
                                    byteSize(plane.type));
      placeRows(plane.bytes, box, window, byteSize(plane.type), placed);
      plane.bytes = std::move(placed);
    }
    return planes;
  });
}

std::vector<ExrPlane> planesOf(const Image& image, const std::vector<std::string>& names, ExrPixelType type) {
  std::vector<ExrPlane> planes;
  const size_t numberSize = byteSize(type), channels = static_cast<size_t>(image.channels);
  for (size_t c = 0; c < names.size(); ++c) {
    ExrPlane& plane =
        planes.emplace_back(ExrPlane{names[c], type, std::vector<std::byte>(image.pixelCount() * numberSize)});
    for (size_t p = 0; p < image.pixelCount(); ++p) {
      const float value = image.pixels[p * channels + c];
      constexpr auto kLargest = static_cast<float>(HALF_MAX);
      const half rounded(std::isfinite(value) ? std::clamp(value, -kLargest, kLargest) : value);
      std::memcpy(&plane.bytes[p * numberSize],
                  type == ExrPixelType::kHalf ? static_cast<const void*>(&rounded) : &value, numberSize);
    }
  }
  return planes;
}

}  // namespace xrds
