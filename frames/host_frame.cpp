#include "frames/host_frame.h"

#include "shaders/exposure/exposure.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint64_t kExposureBytes = 4 * sizeof(float);

Rectangle scaled(const Rectangle& part, uint32_t scale) {
  return {part.x * static_cast<int32_t>(scale), part.y * scale, part.width * scale, part.height * scale};
}

uint64_t imageBytes(const HostPixels& pixels) { return pixels.rowBytes * pixels.height; }

}  // namespace

HostFrame::HostFrame(Gpu& gpu, std::span<const FramePart> parts, const HostPictures& given,
                     std::span<const FramePart> alphaParts)
    : gpu_(gpu) {
  XRDS_CHECK_LT(0u, parts.size());
  HostPictures pictures = given;
  const auto read = [&](HostPicture& picture) {
    if (!picture.image) return;
    const HostImage* const image = picture.image;
    picture = inBuffer(picture);
    copy({.byteSize = imageBytes(picture.pixels), .image = image}, {picture.buffer, 0, imageBytes(picture.pixels)});
  };
  read(pictures.colour);
  for (HostPicture& picture : pictures.auxiliary) read(picture);
  if (pictures.output.image) pictures.output = inBuffer(pictures.output);
  addParts(parts, pictures);
  if (!alphaParts.empty()) {
    read(pictures.alpha);
    HostPictures alpha{.colour = pictures.alpha, .output = pictures.output, .exposure = 1.F};
    alpha.colour.pixels.isAlpha = alpha.output.pixels.isAlpha = true;
    addParts(alphaParts, alpha);
  }
  if (given.output.image) {
    const uint64_t byteSize = imageBytes(pictures.output.pixels);
    copy({pictures.output.buffer, 0, byteSize}, {.byteSize = byteSize, .image = given.output.image});
  }
}

const Buffer& HostFrame::ownBuffer(uint64_t byteSize) { return own_.emplace_back(gpu_, byteSize); }

// Where an image is copied to or from: rows without gaps.
HostPicture HostFrame::inBuffer(const HostPicture& picture) {
  HostPicture packed{.pixels = picture.pixels};
  packed.pixels.byteOffset = 0;
  packed.pixels.rowBytes = uint64_t{picture.pixels.width} * picture.pixels.channels * byteSize(picture.pixels.type);
  packed.buffer = &ownBuffer(imageBytes(packed.pixels));
  return packed;
}

void HostFrame::copy(const ByteRange& from, const ByteRange& to) {
  PlacedDispatch placed;
  placed.dispatch.program = "copy";
  placed.dispatch.bindings = {{.access = Access::read, .kind = BindingKind::copied},
                              {.access = Access::write, .kind = BindingKind::copied}};
  placed.ranges = {from, to};
  placed_.push_back(std::move(placed));
}

void HostFrame::place(std::span<const Dispatch> dispatches, const Buffer& host, const Buffer& graph,
                      uint64_t graphOffset) {
  for (const Dispatch& dispatch : dispatches) {
    PlacedDispatch placed{dispatch, {}};
    for (const Binding& binding : dispatch.bindings)
      placed.ranges.push_back(binding.value == 0
                                  ? ByteRange{&host, binding.byteOffset, binding.byteSize}
                                  : ByteRange{&graph, graphOffset + binding.byteOffset, binding.byteSize});
    placed_.push_back(std::move(placed));
  }
}

void HostFrame::take(const HostPicture& from, const Rectangle& part, const TensorView& to, const Buffer& graph,
                     uint64_t offset, uint32_t channel, uint32_t cleared) {
  const TakePixels take{from.pixels, to, part.x, part.y, channel, cleared};
  place(xrds::dispatches(take, gpu_.traits()), *from.buffer, graph, offset);
}

// A buffer with the exposure, from where each part takes it; null: their one session computes it.
const Buffer* HostFrame::prepareExposure(std::span<const FramePart> parts, const HostPictures& pictures) {
  if (parts.front().session->graph().computesExposure()) return nullptr;
  Buffer& exposure = own_.emplace_back(gpu_, kExposureBytes);
  if (pictures.exposureBuffer) {
    const Dispatch launch = takeExposure(pictures.exposureOffset);
    place({&launch, 1}, *pictures.exposureBuffer, exposure, 0);
  } else if (pictures.exposure) {
    const float numbers[4] = {*pictures.exposure, 1 / *pictures.exposure, 0, 0};
    exposure.upload(0, std::as_bytes(std::span(numbers)));
  } else {
    const HostPixels& pixels = pictures.colour.pixels;
    const TensorView colour{1, DataType::f32, pixels.height, pixels.width, 4, 0, 4},
        result{2, DataType::f32, 1, 1, 4, 0, 4};
    if (colour.pixelCount() > gpu_.traits().maxTexelBufferElements)
      throw Error("The device cannot bind a colour of " + std::to_string(colour.pixelCount()) +
                  " pixels at once, from which its exposure is computed: give the exposure.");
    const Buffer& whole = ownBuffer(colour.storedByteSize());
    take(pictures.colour, {0, 0, pixels.width, pixels.height}, colour, whole, 0, 0, 1);
    placed_.push_back({dispatch(Exposure{colour, result}, gpu_.traits()),
                       {{&whole, 0, colour.storedByteSize()}, {&exposure, 0, kExposureBytes}}});
  }
  return &exposure;
}

void HostFrame::addParts(std::span<const FramePart> parts, const HostPictures& pictures) {
  const Buffer* const exposure = prepareExposure(parts, pictures);
  for (const FramePart& part : parts) addPart(part, pictures, exposure);
}

void HostFrame::addPart(const FramePart& part, const HostPictures& pictures, const Buffer* exposure) {
  const Session& session = *part.session;
  const Graph& graph = session.graph();
  const Buffer& arena = session.arena();
  const uint32_t scale = graph.output.width / graph.colour.width;
  const Rectangle &crop = part.tile.crop, &inner = part.tile.inner;
  take(pictures.colour, crop, graph.colour, arena, session.placeOf(graph.colour), 0, 1);
  const auto count = static_cast<uint32_t>(pictures.auxiliary.size());
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t cleared = i + 1 < count ? 0 : graph.auxiliary.channels - 3 * count;
    take(pictures.auxiliary[i], scaled(crop, scale), graph.auxiliary, arena, session.placeOf(graph.auxiliary), 3 * i,
         cleared);
  }
  if (exposure) copy({exposure, 0, kExposureBytes}, {&arena, session.placeOf(graph.exposure), kExposureBytes});
  placed_.insert(placed_.end(), session.dispatches().begin(), session.dispatches().end());
  const Rectangle kept = scaled(inner, scale);
  const GivePixels give{.source = graph.output,
                        .target = pictures.output.pixels,
                        .left = static_cast<uint32_t>(inner.x - crop.x) * scale,
                        .top = (inner.y - crop.y) * scale,
                        .x = static_cast<uint32_t>(kept.x),
                        .y = kept.y,
                        .width = kept.width,
                        .height = kept.height};
  place(xrds::dispatches(give, gpu_.traits()), *pictures.output.buffer, arena, session.placeOf(graph.output));
}

}  // namespace xrds
