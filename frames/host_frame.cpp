#include "frames/host_frame.h"

#include "shaders/exposure/exposure.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint64_t kExposureBytes = 4 * sizeof(float);

Rectangle scaled(const Rectangle& part, uint32_t scale) {
  return {part.x * static_cast<int32_t>(scale), part.y * scale, part.width * scale, part.height * scale};
}

}  // namespace

HostFrame::HostFrame(Gpu& gpu, std::span<const FramePart> parts, const HostPictures& given,
                     std::span<const FramePart> alphaParts)
    : gpu_(gpu), steps_(gpu) {
  XRDS_CHECK_LT(0u, parts.size());
  HostPictures pictures = given;
  pictures.colour = steps_.read(pictures.colour);
  for (HostPicture& picture : pictures.auxiliary) picture = steps_.read(picture);
  if (pictures.output.image) pictures.output = steps_.inBuffer(pictures.output);
  addParts(parts, pictures);
  if (!alphaParts.empty()) {
    HostPictures alpha{.colour = steps_.read(pictures.alpha), .output = pictures.output, .exposure = 1.F};
    alpha.colour.pixels.isAlpha = alpha.output.pixels.isAlpha = true;
    addParts(alphaParts, alpha);
  }
  if (given.output.image) {
    const HostPixels& pixels = pictures.output.pixels;
    const uint64_t byteSize = pixels.rowBytes * pixels.height;
    steps_.copy({pictures.output.buffer, 0, byteSize}, {.byteSize = byteSize, .image = given.output.image});
  }
}

// A buffer with the exposure, from where each part takes it; null: their one session computes it.
const Buffer* HostFrame::prepareExposure(std::span<const FramePart> parts, const HostPictures& pictures) {
  if (parts.front().session->graph().computesExposure()) return nullptr;
  const TensorView result = steps_.images().create("exposure", {1, 1, 4});
  Buffer& exposure = steps_.images().bufferOf(result);
  if (pictures.exposureBuffer) {
    const Dispatch launch = takeExposure(pictures.exposureOffset);
    steps_.place({&launch, 1}, *pictures.exposureBuffer, exposure, 0);
  } else if (pictures.exposure) {
    const float numbers[4] = {*pictures.exposure, 1 / *pictures.exposure, 0, 0};
    exposure.upload(0, std::as_bytes(std::span(numbers)));
  } else {
    const HostPixels& pixels = pictures.colour.pixels;
    if (uint64_t{pixels.width} * pixels.height > gpu_.traits().maxTexelBufferElements)
      throw Error("The device cannot bind a colour of " + std::to_string(uint64_t{pixels.width} * pixels.height) +
                  " pixels at once, from which its exposure is computed: give the exposure.");
    const TensorView colour = steps_.taken(pictures.colour);
    steps_.run({pictures.binnedExposure ? Operator(BinnedExposure{colour, result}) : Exposure{colour, result}});
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
  steps_.take(pictures.colour, crop, graph.colour, arena, session.placeOf(graph.colour), 0, 1);
  const auto count = static_cast<uint32_t>(pictures.auxiliary.size());
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t cleared = i + 1 < count ? 0 : graph.auxiliary.channels - 3 * count;
    steps_.take(pictures.auxiliary[i], scaled(crop, scale), graph.auxiliary, arena, session.placeOf(graph.auxiliary),
                3 * i, cleared);
  }
  if (exposure) steps_.copy({exposure, 0, kExposureBytes}, {&arena, session.placeOf(graph.exposure), kExposureBytes});
  steps_.add(session.dispatches());
  const Rectangle kept = scaled(inner, scale);
  const GivePixels give{.source = graph.output,
                        .target = pictures.output.pixels,
                        .left = static_cast<uint32_t>(inner.x - crop.x) * scale,
                        .top = (inner.y - crop.y) * scale,
                        .x = static_cast<uint32_t>(kept.x),
                        .y = kept.y,
                        .width = kept.width,
                        .height = kept.height,
                        .marksLost = pictures.marksLost};
  steps_.place(xrds::dispatches(give, gpu_.traits()), *pictures.output.buffer, arena, session.placeOf(graph.output));
}

}  // namespace xrds
