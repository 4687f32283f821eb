#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <string>

#include "xrds/xrds.h"

namespace xrds::python {

namespace nb = nanobind;

/// An array [height, width, channels] of Python's, or [height, width] of distances, as an image of the library. Keeps
/// the array alive.
class Image {
 public:
  /// `name`: what sentences call it. Raises TypeError if it is no array of 16 or 32-bit floats on the CPU, or is to be
  /// written and cannot be; ArgumentError for shapes that are no image.
  Image(nb::handle array, std::string name, bool writable);

  const XrdsImage& view() const { return view_; }
  const std::string& name() const { return name_; }
  uint32_t channels() const { return channels_; }
  const char* type() const { return view_.format == XRDS_HALF ? "float16" : "float32"; }
  /// Whether any bytes between the first and the last of both are the same.
  bool overlaps(const Image& other) const;

 private:
  void setView(void* pixels, const int64_t* shape, const int64_t* strides, size_t dimensions);

  std::string name_;
  nb::ndarray<nb::ro> array_;
  XrdsImage view_{};
  uint32_t channels_ = 1;
};

}  // namespace xrds::python
