#include "image/box.h"

#include <algorithm>
#include <limits>

#include "xrds/error.h"

namespace xrds {
namespace {

int32_t checkedCoordinate(int64_t value, const Box& box, int scale) {
  if (value < std::numeric_limits<int32_t>::min() || value > std::numeric_limits<int32_t>::max()) {
    throw Error("The window " + toString(box) + " cannot be scaled by " + std::to_string(scale) +
                ": expected corners within 32 bits, found " + std::to_string(value) + "; use a smaller scale.");
  }
  return static_cast<int32_t>(value);
}

}  // namespace

std::string toString(const Box& box) {
  return std::to_string(box.width()) + " x " + std::to_string(box.height()) + " at (" + std::to_string(box.minX) +
         ", " + std::to_string(box.minY) + ")";
}

Box scaledBox(const Box& box, int scale) {
  if (scale < 1) {
    throw Error("A window cannot be scaled by " + std::to_string(scale) + ": expected a positive whole number.");
  }
  const int64_t s = scale;
  Box result;
  result.minX = checkedCoordinate(box.minX * s, box, scale);
  result.minY = checkedCoordinate(box.minY * s, box, scale);
  result.maxX = checkedCoordinate((box.maxX + int64_t{1}) * s - 1, box, scale);
  result.maxY = checkedCoordinate((box.maxY + int64_t{1}) * s - 1, box, scale);
  return result;
}

int scaleBetween(const Box& low, const Box& high) {
  const bool divides = low.width() > 0 && low.height() > 0 && high.width() >= low.width() &&
                       high.height() >= low.height() && high.width() % low.width() == 0 &&
                       high.width() / low.width() <= std::numeric_limits<int32_t>::max() &&
                       high.width() / low.width() * low.height() == high.height();
  if (!divides) {
    throw Error(
        "The auxiliary frame is no whole multiple of the colour frame: expected the same whole scale in both "
        "directions, found " +
        toString(low) + " and " + toString(high) + "; render both from one camera at matching sizes.");
  }
  return static_cast<int>(high.width() / low.width());
}

Image placedInBox(const Image& image, const Box& from, const Box& to) {
  if (image.width != from.width() || image.height != from.height()) {
    throw Error("An image of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                " pixels cannot be placed: expected the size of its window, " + toString(from) + ".");
  }
  if (from == to) {
    return image;
  }
  Image result(static_cast<int>(to.width()), static_cast<int>(to.height()), image.channels);
  const int firstX = std::max(from.minX, to.minX);
  const int lastX = std::min(from.maxX, to.maxX);
  const int firstY = std::max(from.minY, to.minY);
  const int lastY = std::min(from.maxY, to.maxY);
  if (firstX > lastX) {
    return result;
  }
  const int64_t valueCount = (int64_t{lastX} - firstX + 1) * image.channels;
  for (int y = firstY; y <= lastY; ++y) {
    const auto source = image.pixels.begin() + static_cast<ptrdiff_t>(image.index(firstX - from.minX, y - from.minY));
    std::copy_n(source, valueCount,
                result.pixels.begin() + static_cast<ptrdiff_t>(result.index(firstX - to.minX, y - to.minY)));
  }
  return result;
}

}  // namespace xrds
