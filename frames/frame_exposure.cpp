#include "frames/frame_exposure.h"

#include "shaders/binned_exposure/binned_exposure.h"
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
  return static_cast<float>(binnedExposureOf(colour.height, colour.width, [&](uint32_t y, uint32_t x, uint32_t c) {
                              return colour.pixels[(size_t{y} * colour.width + x) * colour.stride + c];
                            }).exposure);
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
