#include "frames/denoised_frame.h"

#include <algorithm>

#include "xrds/auxiliary_input.h"
#include "xrds/error.h"

namespace xrds {
namespace {

void requireBindable(const Gpu& gpu, const HostPixels& pixels) {
  const uint64_t count = uint64_t{pixels.width} * pixels.height;
  if (count > gpu.traits().maxTexelBufferElements)
    throw Error("The device cannot bind an image of " + std::to_string(count) +
                " pixels at once, as denoising first needs it.");
}

}  // namespace

DenoisedFrame::DenoisedFrame(Gpu& gpu, const DenoisingParts& denoising, std::span<const FramePart> upscaling,
                             std::span<const std::string> inputs, const HostPictures& given,
                             std::span<const FramePart> alphaParts)
    : gpu_(gpu), steps_(gpu) {
  HostPictures pictures = given;
  std::vector<HostPicture> guides, lowGuides;
  const uint32_t scale = given.output.pixels.width / given.colour.pixels.width;
  const auto find = [&](const AuxiliaryInput& input) -> HostPicture* {
    const auto found = std::find(inputs.begin(), inputs.end(), input.name);
    return found == inputs.end() ? nullptr : &pictures.auxiliary[found - inputs.begin()];
  };
  requireBindable(gpu, given.output.pixels);
  for (const AuxiliaryInput* const input : {&kAlbedo, &kNormal}) {
    HostPicture* const picture = find(*input);
    if (!picture) continue;
    const TensorView image = input == &kAlbedo          ? cleanAlbedo(denoising.albedo, *picture)
                             : denoising.normal.empty() ? steps_.taken(*picture)
                                                        : denoised(denoising.normal, *picture, {}, false);
    *picture = pictureOf(steps_.images(), image);
    if (guides.size() == denoising.guides) continue;
    const TensorView mean = steps_.images().create("mean", {image.height / scale, image.width / scale, 4});
    steps_.run({BoxMean{image, mean, scale}});
    guides.push_back(*picture);
    lowGuides.push_back(pictureOf(steps_.images(), mean));
  }
  XRDS_CHECK_EQ(guides.size(), denoising.guides);
  for (size_t i = 0; i < inputs.size(); ++i)
    if (findAuxiliaryInput(inputs[i])->isRadiance)
      pictures.auxiliary[i] = pictureOf(steps_.images(), denoised(denoising.full, pictures.auxiliary[i], guides, true));
  pictures.colour = pictureOf(steps_.images(), denoised(denoising.low, pictures.colour, lowGuides, true));
  add(upscaling, pictures, alphaParts);
}

// With what it has above 1.
TensorView DenoisedFrame::cleanAlbedo(std::span<const FramePart> parts, const HostPicture& albedo) {
  const TensorView given = steps_.taken(albedo);
  if (parts.empty()) return given;
  const TensorView inside = denoised(parts, pictureOf(steps_.images(), given), {}, false);
  const TensorView result = steps_.images().create("albedo", given.shape());
  steps_.run({AddExcess{inside, given, result}});
  return result;
}

TensorView DenoisedFrame::denoised(std::span<const FramePart> parts, const HostPicture& picture,
                                   std::span<const HostPicture> guides, bool isRadiance) {
  const TensorView result = steps_.images().create("denoised", {picture.pixels.height, picture.pixels.width, 4});
  HostPictures pictures{.colour = picture,
                        .auxiliary = {guides.begin(), guides.end()},
                        .output = pictureOf(steps_.images(), result),
                        .binnedExposure = isRadiance};
  if (!isRadiance) pictures.exposure = 1.F;
  add(parts, pictures);
  return result;
}

void DenoisedFrame::add(std::span<const FramePart> parts, const HostPictures& pictures,
                        std::span<const FramePart> alphaParts) {
  steps_.add(frames_.emplace_back(gpu_, parts, pictures, alphaParts).dispatches());
}

uint64_t DenoisedFrame::byteSize() const {
  uint64_t sum = steps_.byteSize();
  for (const HostFrame& frame : frames_) sum += frame.byteSize();
  return sum;
}

}  // namespace xrds
