#include "frames/frame_input.h"

#include <algorithm>
#include <mutex>

namespace xrds {

void copyRow(const PixelView& image, int64_t x, uint32_t y, uint32_t width, float* to, uint32_t stride) {
  const float* row = image.pixels + uint64_t{y} * image.width * image.stride;
  auto column = static_cast<uint32_t>((x % image.width + image.width) % image.width);
  for (uint32_t left = width; left > 0; column = 0) {
    const uint32_t count = std::min(left, image.width - column);
    const float* from = row + size_t{column} * image.stride;
    for (uint32_t i = 0; i < count; ++i, from += image.stride, to += stride) std::copy_n(from, 3, to);
    left -= count;
  }
}

void storeRow(std::span<const float> row, uint64_t first, std::span<float> output, std::vector<uint64_t>& lost) {
  static std::mutex access;
  std::vector<uint64_t> found;
  for (size_t x = 0; x < row.size() / 4; ++x) {
    std::copy_n(&row[4 * x], 3, &output[3 * (first + x)]);
    if (row[4 * x + 3] != 0) found.push_back(first + x);
  }
  if (found.empty()) return;
  const std::lock_guard lock(access);
  lost.insert(lost.end(), found.begin(), found.end());
}

std::vector<float> packed(const PixelView& image) {
  std::vector<float> pixels(size_t{3} * image.width * image.height);
  for (uint32_t y = 0; y < image.height; ++y)
    copyRow(image, 0, y, image.width, &pixels[size_t{3} * y * image.width], 3);
  return pixels;
}

}  // namespace xrds
