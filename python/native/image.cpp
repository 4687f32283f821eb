#include "python/native/image.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "python/native/call.h"

namespace xrds::python {
namespace {

[[noreturn]] void refuseType(const std::string& sentence) { throw nb::type_error(sentence.c_str()); }

std::string typeName(nb::handle object) { return nb::inst_name(object).c_str(); }

template <class Array>
Array arrayOf(nb::handle object, const std::string& name, const char* needed) {
  Array array;
  if (!nb::try_cast(object, array, false))
    refuseType("The " + name + " is of type " + typeName(object) + ", expected " + needed +
               ": a NumPy array, or anything that numpy.from_dlpack() reads.");
  return array;
}

nb::ndarray<nb::ro> readable(nb::handle object, const std::string& name, bool writable) {
  if (object.is_none()) refuseType("The " + name + " is None, expected an array.");
  if (!writable) return arrayOf<nb::ndarray<nb::ro>>(object, name, "an array");
  return nb::ndarray<nb::ro>(arrayOf<nb::ndarray<>>(object, name, "an array that can be written"));
}

std::string shapeText(const int64_t* shape, size_t dimensions) {
  std::string text = "[";
  for (size_t i = 0; i < dimensions; ++i) text += (i ? ", " : "") + std::to_string(shape[i]);
  return text + "]";
}

bool isImage(const int64_t* shape, size_t dimensions, bool mayBeDistances) {
  constexpr int64_t kMost = std::numeric_limits<uint32_t>::max();
  if (dimensions != 2 && dimensions != 3) return false;
  const int64_t channels = dimensions == 3 ? shape[2] : 1;
  return shape[0] >= 1 && shape[1] >= 1 && shape[0] <= kMost && shape[1] <= kMost &&
         (channels == 3 || channels == 4 || (channels == 1 && mayBeDistances));
}

// Of the first and behind the last byte.
std::pair<const std::byte*, const std::byte*> extent(const XrdsImage& image) {
  const ptrdiff_t number = image.format == XRDS_HALF ? 2 : 4;
  const auto* low = static_cast<const std::byte*>(image.channels[0]);
  const auto* high = low;
  for (void* const channel : image.channels) {
    if (!channel) continue;
    low = std::min(low, static_cast<const std::byte*>(channel));
    high = std::max(high, static_cast<const std::byte*>(channel));
  }
  const ptrdiff_t steps[] = {image.pixelStride * (ptrdiff_t{image.width} - 1),
                             image.rowStride * (ptrdiff_t{image.height} - 1)};
  for (const ptrdiff_t step : steps) (step < 0 ? low : high) += step;
  return {low, high + number};
}

}  // namespace

Image::Image(nb::handle array, std::string name, bool writable)
    : name_(std::move(name)), array_(readable(array, name_, writable)) {
  if (array_.device_type() != nb::device::cpu::value)
    refuseType("The " + name_ + " is not in the memory of the CPU: copy it there first, as tensor.cpu() does.");
  const auto type = array_.dtype();
  if (type.code != static_cast<uint8_t>(nb::dlpack::dtype_code::Float) || type.lanes != 1 ||
      (type.bits != 16 && type.bits != 32))
    refuseType("The " + name_ + " has numbers of another type, expected float16 or float32: convert it first, as " +
               "array.astype(numpy.float32) does.");
  const bool isDepth = name_ == "depth";
  if (!isImage(array_.shape_ptr(), array_.ndim(), isDepth))
    refuse("The " + name_ + " has the shape " + shapeText(array_.shape_ptr(), array_.ndim()) + ", expected " +
           (isDepth ? "[height, width] of distances." : "[height, width, 3], or 4 channels with alpha."));
  view_.format = type.bits == 16 ? XRDS_HALF : XRDS_FLOAT;
  setView(const_cast<void*>(array_.data()), array_.shape_ptr(), array_.stride_ptr(), array_.ndim());
}

void Image::setView(void* pixels, const int64_t* shape, const int64_t* strides, size_t dimensions) {
  const ptrdiff_t number = view_.format == XRDS_HALF ? 2 : 4;
  view_.height = static_cast<uint32_t>(shape[0]);
  view_.width = static_cast<uint32_t>(shape[1]);
  view_.rowStride = strides[0] * number;
  view_.pixelStride = strides[1] * number;
  channels_ = dimensions == 3 ? static_cast<uint32_t>(shape[2]) : 1;
  for (uint32_t c = 0; c < channels_; ++c)
    view_.channels[c] = static_cast<std::byte*>(pixels) + (c ? c * strides[2] * number : 0);
}

bool Image::overlaps(const Image& other) const {
  const auto [low, high] = extent(view_);
  const auto [otherLow, otherHigh] = extent(other.view_);
  return low < otherHigh && otherLow < high;
}

}  // namespace xrds::python
