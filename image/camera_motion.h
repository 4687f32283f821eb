#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "image/exr/file.h"

namespace xrds {

/// A camera as OpenEXR's standard attributes worldToNDC and worldToCamera have it. Each row takes a point (X, Y, Z, 1)
/// of the world, or a direction (X, Y, Z, 0), to one number by its scalar product: (x / w, y / w) is the place in the
/// display window, (0, 0) its upper left and (1, 1) its lower right corner; w > 0 in front of the camera; depth is the
/// distance along the viewing direction.
struct FrameCamera {
  using Row = std::array<double, 4>;
  Row x{}, y{}, w{}, depth{};
};

/// The camera of a part. Without worldToCamera the depth is that of a perspective worldToNDC. Nothing if there is no
/// worldToNDC. Throws Error where x does not point to the right or y not down, or the depth is not known.
std::optional<FrameCamera> cameraOf(const ExrPart& part);

/// Where what each pixel shows stood in another frame, if the camera alone moves: the place there less the place here,
/// x to the right and y down, in pixels, two floats for each pixel of `dataWindow`. `depths`: along the viewing
/// direction, one a pixel; what is not finite, 0 or less, or at least 1e8 is infinitely far. Infinite where the other
/// camera has it behind itself. With the homogeneous point P for which x - u w, y - v w and nearness depth - 1 vanish.
std::vector<float> cameraMotion(const FrameCamera& present, const FrameCamera& other, std::span<const float> depths,
                                const Box& dataWindow, const Box& displayWindow);

}  // namespace xrds
