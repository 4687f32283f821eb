#pragma once

#include <string>
#include <vector>

#include "xrds/pixel_view.h"
#include "xrds/xrds.h"

namespace xrds::c {

/// Throws InvalidArgument, which calls the image `what`, unless it has so many channels and can be one.
void checkImage(const XrdsImage& image, const std::string& what, uint32_t channels);

/// Three channels of an image as the library reads them: the caller's own pixels where they are laid out so, else a
/// copy.
class ReadImage {
 public:
  /// Throws as checkImage() does.
  ReadImage(const XrdsImage& image, const std::string& what);
  /// Pixels of the library's own, three floats each.
  ReadImage(std::vector<float> pixels, uint32_t width, uint32_t height);
  ReadImage(ReadImage&&) = default;  // the pixels of a copy stay where they are
  const PixelView& view() const { return view_; }

 private:
  std::vector<float> copy_;
  PixelView view_;
};

/// The images of a frame for a model with those inputs.
struct ReadImages {
  /// Throws InvalidArgument if their number is another one, or as checkImage() does.
  ReadImages(const std::vector<std::string>& inputs, const XrdsImage& colour, const XrdsImage* auxiliary,
             uint32_t count);
  const ReadImage colour;
  std::vector<ReadImage> images;
  std::vector<PixelView> views;  // of the images
};

/// One channel, row by row.
std::vector<float> readChannel(const XrdsImage& image, uint32_t channel);
/// Writes it, from every `step`th of the values on.
void writeChannel(const XrdsImage& image, uint32_t channel, const float* values, size_t step);

/// Bytes of a row without gaps, of pixels with a stride of 0 or more; the largest number where they are more than it.
ptrdiff_t rowBytes(ptrdiff_t pixelStride, uint32_t width);

/// Whether the image is rows of three floats a pixel without gaps.
bool isPacked(const XrdsImage& image);

}  // namespace xrds::c
