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
  /// Adds the number of those pixels to `repaired`.
  FiniteImage(const PixelView& given, PixelKind kind, uint64_t& repaired);
  FiniteImage(FiniteImage&&) = default;  // the pixels of the copy stay where they are
  const PixelView& view() const { return view_; }

 private:
  PixelView view_;
  Image copy_;
};

}  // namespace xrds
