#pragma once

#include <span>
#include <string>
#include <vector>

#include "xrds/call.h"
#include "xrds/pixel_view.h"

namespace xrds::call {

/// Images as the C API has them. Throws InvalidArgument, which calls the image `what`, if its pixels overlap.
inline XrdsImage image(const PixelView& view, const std::string& what) {
  if (view.pixels && view.stride < 3)
    throw InvalidArgument("The " + what + " image has a stride of " + std::to_string(view.stride) +
                          " floats from pixel to pixel, expected at least 3.");
  XrdsImage image{};
  auto* const pixels = const_cast<float*>(view.pixels);  // which the library only reads
  for (int c = 0; c < 3 && pixels; ++c) image.channels[c] = pixels + c;
  image.pixelStride = static_cast<ptrdiff_t>(view.stride * sizeof(float));
  image.rowStride = image.pixelStride * static_cast<ptrdiff_t>(view.width);
  image.width = view.width;
  image.height = view.height;
  return image;
}
/// names: of the model's inputs.
inline std::vector<XrdsImage> images(std::span<const PixelView> views, std::span<const std::string> names) {
  std::vector<XrdsImage> images;
  for (size_t i = 0; i < views.size(); ++i)
    images.push_back(image(views[i], i < names.size() ? names[i] : "auxiliary"));
  return images;
}
inline XrdsImage image(std::span<float> pixels, uint32_t width, uint32_t height) {
  return image(PixelView{pixels.data(), width, height}, "output");
}
/// Room for an output of width x height pixels; throws InvalidArgument, which calls it `what`, if there is more or
/// less.
inline XrdsImage output(const std::string& what, std::span<float> pixels, uint32_t width, uint32_t height) {
  const size_t numbers = size_t{3} * width * height;
  if (pixels.size() != numbers)
    throw InvalidArgument("The " + what + " has room for " + std::to_string(pixels.size()) + " numbers, expected " +
                          std::to_string(numbers) + ": 3 for each of its " + std::to_string(width) + " x " +
                          std::to_string(height) + " pixels.");
  return image(pixels, width, height);
}

}  // namespace xrds::call
