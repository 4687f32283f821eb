#include "frames/frame_steps.h"

namespace xrds {
namespace {

uint64_t imageBytes(const HostPixels& pixels) { return pixels.rowBytes * pixels.height; }

}  // namespace

HostPicture pictureOf(const DeviceImages& images, const TensorView& image) {
  XRDS_CHECK_EQ(image.channels, 4u);
  return {.pixels = {.rowBytes = image.rowByteSize(), .width = image.width, .height = image.height, .channels = 4},
          .buffer = &images.bufferOf(image)};
}

HostPicture FrameSteps::inBuffer(const HostPicture& picture) {
  HostPicture packed{.pixels = picture.pixels};
  packed.pixels.byteOffset = 0;
  packed.pixels.rowBytes =
      uint64_t{picture.pixels.width} * picture.pixels.channels * xrds::byteSize(picture.pixels.type);
  packed.buffer = &copies_.emplace_back(gpu_, imageBytes(packed.pixels));
  return packed;
}

HostPicture FrameSteps::read(const HostPicture& picture) {
  if (!picture.image) return picture;
  const HostPicture packed = inBuffer(picture);
  const uint64_t bytes = imageBytes(packed.pixels);
  copy({.byteSize = bytes, .image = picture.image}, {packed.buffer, 0, bytes});
  return packed;
}

void FrameSteps::copy(const ByteRange& from, const ByteRange& to) {
  PlacedDispatch placed;
  placed.dispatch.program = "copy";
  placed.dispatch.bindings = {{.access = Access::read, .kind = BindingKind::copied},
                              {.access = Access::write, .kind = BindingKind::copied}};
  placed.ranges = {from, to};
  placed_.push_back(std::move(placed));
}

void FrameSteps::place(std::span<const Dispatch> launches, const Buffer& host, const Buffer& arena, uint64_t offset) {
  for (const Dispatch& launch : launches) {
    PlacedDispatch placed{launch, {}};
    for (const Binding& binding : launch.bindings)
      placed.ranges.push_back(binding.value == 0 ? ByteRange{&host, binding.byteOffset, binding.byteSize}
                                                 : ByteRange{&arena, offset + binding.byteOffset, binding.byteSize});
    placed_.push_back(std::move(placed));
  }
}

void FrameSteps::take(const HostPicture& from, const Rectangle& part, const TensorView& to, const Buffer& arena,
                      uint64_t offset, uint32_t channel, uint32_t cleared) {
  const TakePixels take{from.pixels, to, part.x, part.y, channel, cleared};
  place(xrds::dispatches(take, gpu_.traits()), *from.buffer, arena, offset);
}

TensorView FrameSteps::taken(const HostPicture& from) {
  const HostPixels& pixels = from.pixels;
  const TensorView to = images_.create("picture", {pixels.height, pixels.width, 4});
  take(read(from), {0, 0, pixels.width, pixels.height}, to, images_.bufferOf(to), 0, 0, 1);
  return to;
}

uint64_t FrameSteps::byteSize() const {
  uint64_t sum = images_.byteSize();
  for (const Buffer& copy : copies_) sum += copy.byteSize();
  return sum;
}

}  // namespace xrds
