#include "image/metrics/image_pair.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "xrds/error.h"

namespace xrds {
namespace {

std::string sizeOf(const Image& image) {
  return std::to_string(image.width) + " x " + std::to_string(image.height) + " x " + std::to_string(image.channels);
}

void requireFinite(const Image& image, const char* name) {
  const auto count = std::count_if(image.pixels.begin(), image.pixels.end(), [](float v) { return !std::isfinite(v); });
  if (count > 0) {
    throw Error(std::string("Images cannot be compared: expected finite values, found ") + std::to_string(count) +
                " others in the " + name + "; repair it first.");
  }
}

}  // namespace

void requireComparable(const Image& result, const Image& reference) {
  if (result.pixels.empty() || result.width != reference.width || result.height != reference.height ||
      result.channels != reference.channels) {
    throw Error("Images cannot be compared: expected equal sizes, found " + sizeOf(result) + " and " +
                sizeOf(reference) + "; crop or scale one of them.");
  }
  requireFinite(result, "result");
  requireFinite(reference, "reference");
}

}  // namespace xrds
