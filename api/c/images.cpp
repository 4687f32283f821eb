#include "api/c/images.h"

#include <cstring>
#include <limits>

#include "api/arguments.h"
#include "api/c/result.h"
#include "api/c/sized.h"
#include "engine/half.h"
#include "xrds/auxiliary_input.h"
#include "xrds/error.h"
#include "xrds/relative_depth.h"

namespace xrds::c {
namespace {

std::byte* pixelAt(const XrdsImage& image, uint32_t channel, uint32_t x, uint32_t y) {
  return static_cast<std::byte*>(image.channels[channel]) + ptrdiff_t{x} * image.pixelStride +
         ptrdiff_t{y} * image.rowStride;
}

// By bytes: strides need not be multiples of a number's size.
float numberAt(const std::byte* place, XrdsFormat format) {
  if (format == XRDS_HALF) {
    uint16_t half;
    std::memcpy(&half, place, sizeof half);
    return fromHalf(half);
  }
  float value;
  std::memcpy(&value, place, sizeof value);
  return value;
}

void setNumber(std::byte* place, XrdsFormat format, float value) {
  if (format == XRDS_HALF) {
    const uint16_t half = toHalf(value);
    std::memcpy(place, &half, sizeof half);
  } else {
    std::memcpy(place, &value, sizeof value);
  }
}

// Whether the three channels lie side by side as aligned floats, rows without gaps.
bool isInterleaved(const XrdsImage& image) {
  const auto* const first = static_cast<const float*>(image.channels[0]);
  const bool together = image.channels[1] == first + 1 && image.channels[2] == first + 2;
  const ptrdiff_t size = sizeof(float);
  return image.format == XRDS_FLOAT && together && image.pixelStride >= 3 * size && image.pixelStride % size == 0 &&
         (image.height == 1 || image.rowStride == rowBytes(image.pixelStride, image.width)) &&
         reinterpret_cast<uintptr_t>(first) % alignof(float) == 0;
}

ReadImage readAuxiliary(const XrdsImage& image, const std::string& input) {
  const AuxiliaryInput* kind = findAuxiliaryInput(input);
  if (!kind || !kind->isDistance || image.channels[1]) return {image, input};
  checkImage(image, input, 1);
  return {relativeDepth(readChannel(image, 0)), image.width, image.height};
}

}  // namespace

void checkImage(const XrdsImage& image, const std::string& what, uint32_t channels) {
  if (const int format = numberOf(image.format); format != XRDS_FLOAT && format != XRDS_HALF)
    throw InvalidArgument("The " + what + " image has the format " + std::to_string(format) +
                          ", expected XRDS_FLOAT or XRDS_HALF.");
  for (uint32_t channel = 0; channel < channels; ++channel)
    if (!image.channels[channel])
      throw InvalidArgument("The " + what + " image has no channel " + std::to_string(channel) +
                            ": its pointer is null.");
  if (image.width == 0 || image.height == 0)
    throw InvalidArgument("The " + what + " image is " + sizeText(image.width, image.height) +
                          " pixels, expected some.");
}

ptrdiff_t rowBytes(ptrdiff_t pixelStride, uint32_t width) {
  constexpr ptrdiff_t kMost = std::numeric_limits<ptrdiff_t>::max();
  return width > 0 && pixelStride > kMost / width ? kMost : pixelStride * width;
}

bool isPacked(const XrdsImage& image) { return isInterleaved(image) && image.pixelStride == 3 * sizeof(float); }

ReadImage::ReadImage(const XrdsImage& image, const std::string& what) {
  checkImage(image, what, 3);
  view_ = {static_cast<const float*>(image.channels[0]), image.width, image.height,
           static_cast<uint32_t>(image.pixelStride / ptrdiff_t{sizeof(float)})};
  if (isInterleaved(image)) return;
  copy_.resize(size_t{3} * image.width * image.height);
  float* next = copy_.data();
  for (uint32_t y = 0; y < image.height; ++y)
    for (uint32_t x = 0; x < image.width; ++x)
      for (uint32_t c = 0; c < 3; ++c) *next++ = numberAt(pixelAt(image, c, x, y), image.format);
  view_ = {copy_.data(), image.width, image.height};
}

ReadImage::ReadImage(std::vector<float> pixels, uint32_t width, uint32_t height)
    : copy_(std::move(pixels)), view_{copy_.data(), width, height} {}

ReadImages::ReadImages(const std::vector<std::string>& inputs, const XrdsImage& low, const XrdsImage* auxiliary,
                       uint32_t count)
    : colour(low, "colour") {
  if (count != inputs.size())
    throw InvalidArgument("The model takes " + std::to_string(inputs.size()) + " auxiliary images, found " +
                          std::to_string(count) + ".");
  images.reserve(count);
  for (uint32_t i = 0; i < count; ++i)
    images.push_back(readAuxiliary((&required(auxiliary, "auxiliary"))[i], inputs[i]));
  for (const ReadImage& image : images) views.push_back(image.view());
}

std::vector<float> readChannel(const XrdsImage& image, uint32_t channel) {
  std::vector<float> values;
  values.reserve(size_t{image.width} * image.height);
  for (uint32_t y = 0; y < image.height; ++y)
    for (uint32_t x = 0; x < image.width; ++x) values.push_back(numberAt(pixelAt(image, channel, x, y), image.format));
  return values;
}

void writeChannel(const XrdsImage& image, uint32_t channel, const float* values, size_t step) {
  for (uint32_t y = 0; y < image.height; ++y)
    for (uint32_t x = 0; x < image.width; ++x, values += step)
      setNumber(pixelAt(image, channel, x, y), image.format, *values);
}

}  // namespace xrds::c
