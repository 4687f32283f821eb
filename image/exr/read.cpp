#include "image/exr/read.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>

#include <cstdint>

#include "image/exr/open.h"

namespace xrds {
namespace {

void checkChannel(const ExrFile& file, const Imf::ChannelList& channels, const std::string& name) {
  const Imf::Channel* channel = channels.findChannel(name);
  const std::string start = "Cannot read channel '" + name + "' of '" + file.path.string() + "': ";
  if (channel == nullptr) {
    throw Error(start + "there is none of this name; " + describe(file) + ".");
  }
  if (channel->type != Imf::HALF && channel->type != Imf::FLOAT) {
    throw Error(start + "expected half or float, found whole numbers; choose another layer.");
  }
  if (channel->xSampling != 1 || channel->ySampling != 1) {
    throw Error(start + "expected one value a pixel, found a subsampled channel; choose another layer.");
  }
}

void checkPart(const ExrFile& file, const ExrSelection& selection) {
  const std::string start = "Cannot read part " + std::to_string(selection.part) + " of '" + file.path.string() + "': ";
  if (selection.part >= file.parts.size()) {
    throw Error(start + "the file has " + std::to_string(file.parts.size()) + " parts, counted from 0.");
  }
  if (file.parts[selection.part].deep) {
    throw Error(start + "expected a flat image, found deep samples; flatten it first.");
  }
}

// The rows of `image` are the rows of the part from `firstRow` on.
Imf::FrameBuffer frameBufferFor(Image& image, const Box& box, int firstRow,
                                const std::vector<std::string>& channelNames) {
  Imf::FrameBuffer buffer;
  const size_t pixelStride = channelNames.size() * sizeof(float);
  const size_t rowStride = pixelStride * static_cast<size_t>(image.width);
  for (size_t c = 0; c < channelNames.size(); ++c) {
    buffer.insert(channelNames[c], Imf::Slice::Make(Imf::FLOAT, &image.pixels[c], Imath::V2i(box.minX, firstRow),
                                                    image.width, image.height, pixelStride, rowStride));
  }
  return buffer;
}

// The one channel of a grey layer was read into the last of its places.
void repeatGrey(Image& image) {
  for (size_t p = 0; p < image.pixels.size(); p += 3) image.pixels[p] = image.pixels[p + 1] = image.pixels[p + 2];
}

// Decodes one row, so that a file cut short is refused before memory for all rows is taken.
void probeRow(Imf::InputPart& input, const Box& box, int row, const std::vector<std::string>& channelNames) {
  Image oneRow(static_cast<int>(box.width()), 1, static_cast<int>(channelNames.size()));
  input.setFrameBuffer(frameBufferFor(oneRow, box, row, channelNames));
  input.readPixels(row, row);
}

}  // namespace

Image readLayer(const ExrFile& file, const ExrSelection& selection) {
  checkPart(file, selection);
  return withExrErrors(file.path, [&] {
    const auto opened = openExr(file.path);
    const Box& box = file.parts[selection.part].dataWindow;
    Imf::InputPart input(*opened, static_cast<int>(selection.part));
    const Imath::Box2i& found = input.header().dataWindow();
    if (Box{found.min.x, found.min.y, found.max.x, found.max.y} != box) {
      throw Error("Cannot read '" + file.path.string() + "': it changed while it was being read; try again.");
    }
    for (const std::string& name : selection.channelNames) {
      checkChannel(file, input.header().channels(), name);
    }
    probeRow(input, box, box.minY, selection.channelNames);
    probeRow(input, box, box.maxY, selection.channelNames);
    Image image(static_cast<int>(box.width()), static_cast<int>(box.height()),
                static_cast<int>(selection.channelNames.size()));
    input.setFrameBuffer(frameBufferFor(image, box, box.minY, selection.channelNames));
    input.readPixels(box.minY, box.maxY);
    if (selection.isGrey()) repeatGrey(image);
    return image;
  });
}

}  // namespace xrds
