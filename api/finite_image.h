#pragma once

#include "image/image.h"
#include "xrds/pixel_view.h"

namespace xrds {

/// A copy with three channels.
Image imageOf(const PixelView& view);

enum class PixelKind : uint8_t { radiance, other };  // of radiance nothing is filled with what is negative

/// An image of the caller, or a repaired copy if it has pixels that are not finite.
class FiniteImage {
 public:
  FiniteImage(const PixelView& given, PixelKind kind);
  FiniteImage(FiniteImage&&) = default;  // the pixels of the copy stay where they are
  const PixelView& view() const { return view_; }
  uint64_t repaired() const { return repaired_; }  // how many pixels

 private:
  PixelView view_;
  Image copy_;
  uint64_t repaired_ = 0;
};

}  // namespace xrds
