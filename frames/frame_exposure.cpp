#include "frames/frame_exposure.h"

#include <algorithm>
#include <cmath>

#include "shaders/exposure/exposure.h"

namespace xrds {

FrameExposure exposureOnHost(const PixelView& colour) {
  const auto [exposure, count] = automaticExposure(uint64_t{colour.width} * colour.height, [&](uint64_t i) {
    const float* rgb = colour.pixels + i * colour.stride;
    return luminance(rgb[0], rgb[1], rgb[2]);
  });
  return {static_cast<float>(exposure), static_cast<float>(1 / exposure)};
}

FrameExposure binnedExposure(const PixelView& colour) {
  constexpr uint32_t kBin = 16;
  constexpr double kDarkest = 1e-8, kBrightest = 3.4028234e38;
  const uint64_t rows = ceilDivide(colour.height, kBin), columns = ceilDivide(colour.width, kBin);
  const auto inside = [&](float value) { return value > 0 ? std::min<double>(value, kBrightest) : 0.0; };  // NaN: 0
  double logarithms = 0;
  uint64_t count = 0;
  for (uint64_t i = 0; i < rows; ++i)
    for (uint64_t j = 0; j < columns; ++j) {
      const uint64_t top = i * colour.height / rows, bottom = (i + 1) * colour.height / rows;
      const uint64_t left = j * colour.width / columns, right = (j + 1) * colour.width / columns;
      double sum = 0;
      for (uint64_t y = top; y < bottom; ++y)
        for (uint64_t x = left; x < right; ++x) {
          const float* rgb = colour.pixels + (y * colour.width + x) * colour.stride;
          sum += 0.212671 * inside(rgb[0]) + 0.715160 * inside(rgb[1]) + 0.072169 * inside(rgb[2]);
        }
      const double luminance = sum / static_cast<double>((bottom - top) * (right - left));
      if (luminance <= kDarkest) continue;
      logarithms += std::log(luminance);
      ++count;
    }
  if (count == 0) return {};
  return static_cast<float>(0.18 / std::exp(logarithms / static_cast<double>(count)));
}

FrameExposure exposureOf(Gpu& gpu, const PixelView& colour, Buffer& scratch) {
  const TensorView image{0, DataType::f32, colour.height, colour.width, 4, 0, 4};
  const TensorView result{1, DataType::f32, 1, 1, 4, 0, 4};
  const uint64_t resultOffset = ceilDivide(image.storedByteSize(), kBindingAlignment) * kBindingAlignment;
  if (resultOffset + result.storedByteSize() > scratch.byteSize() ||
      image.pixelCount() > gpu.traits().maxTexelBufferElements)
    return exposureOnHost(colour);
  scratch.uploadRows(0, uint64_t{colour.width} * 4 * sizeof(float), colour.height,
                     [&](uint32_t y, std::span<std::byte> row) {
                       copyRow(colour, 0, y, colour.width, reinterpret_cast<float*>(row.data()), 4);
                     });
  const PlacedDispatch placed{
      dispatch(Exposure{image, result}, gpu.traits()),
      {{&scratch, 0, image.storedByteSize()}, {&scratch, resultOffset, result.storedByteSize()}}};
  Recording(gpu, std::span(&placed, 1)).run();
  float numbers[4];
  scratch.download(resultOffset, std::as_writable_bytes(std::span(numbers)));
  return {numbers[0], numbers[1]};
}

}  // namespace xrds
