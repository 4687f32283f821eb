#include "graph/frame_exposure.h"

#include <algorithm>
#include <cmath>

#include "graph/frame_input.h"
#include "shaders/exposure/exposure.h"

namespace xrds {

FrameExposure exposureOnHost(const PixelView& colour) {
  double sum = 0, count = 0;
  for (uint64_t p = 0; p < uint64_t{colour.width} * colour.height; ++p) {
    const float* rgb = colour.pixels + p * colour.stride;
    const double luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    if (!std::isfinite(luminance) || luminance <= double{shader::kExposureMinLuminance}) continue;
    sum += std::log(luminance);
    ++count;
  }
  const double exposure = count > 0 ? double{shader::kExposureKey} / std::exp(sum / count) : 1;
  const double bounded = std::max(exposure, double{shader::kExposureMin});
  return {static_cast<float>(bounded), static_cast<float>(1 / bounded)};
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
