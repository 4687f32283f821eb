#pragma once

#include <deque>

#include "api/c/images.h"
#include "xrds/layers.h"

namespace xrds::c {

/// The layers of a call as the library takes them, and their results on the way to the caller's images.
class Layers {
 public:
  /// Results have the size of the picture.
  explicit Layers(const XrdsImage& picture) : width_(picture.width), height_(picture.height) {}
  /// Throws InvalidArgument if a structure or an image cannot be.
  void add(const XrdsLayerSet& given);
  std::span<const LayerSet> sets() const { return sets_; }
  /// Writes the results to the images that are not laid out as the library's.
  void write() const;

 private:
  PixelView read(const XrdsImage& image, const std::string& what);
  std::span<float> place(const XrdsImage& image, const std::string& what);

  struct Result {
    XrdsImage image;
    std::vector<float> pixels;
  };
  std::deque<ReadImage> images_;  // which stay where they are, as the results do
  std::deque<Result> results_;
  std::vector<LayerSet> sets_;
  const uint32_t width_, height_;
};

}  // namespace xrds::c
