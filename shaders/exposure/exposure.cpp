#include "shaders/exposure/exposure.h"

#include <algorithm>
#include <cmath>

namespace xrds {

TensorShape outputShape(const Exposure& op) {
  checkView(op.colour, {op.colour.height, op.colour.width, 4});
  XRDS_CHECK_LT(uint64_t{0}, op.colour.pixelCount());
  return {1, 1, 4};
}

Dispatch dispatch(const Exposure& op, const DeviceTraits&) {
  checkView(op.output, outputShape(op));
  XRDS_CHECK(op.output.type == DataType::f32);
  const shader::ExposureParams params{.source = sliceOf(op.colour),
                                      .pixelCount = static_cast<uint32_t>(op.colour.pixelCount()),
                                      .target = sliceOf(op.output).offset};
  return {.program = programName("exposure", KernelFamily::plain, op.output.type),
          .bindings = {readTexels(op.colour), writeRows(op.output, {0, 1})},
          .pushConstants = pushBytes(params)};
}

std::vector<float> packedWeights(const Exposure&, const DeviceTraits&) { return {}; }

void reference(const Exposure& op, HostMemory& memory) {
  outputShape(op);
  double sum = 0, count = 0;
  for (uint32_t y = 0; y < op.colour.height; ++y)
    for (uint32_t x = 0; x < op.colour.width; ++x) {
      const double luminance = 0.2126 * memory.at(op.colour, y, x, 0) + 0.7152 * memory.at(op.colour, y, x, 1) +
                               0.0722 * memory.at(op.colour, y, x, 2);
      if (!std::isfinite(luminance) || luminance <= 1e-8) continue;
      sum += std::log(luminance);
      ++count;
    }
  const double exposure = count > 0 ? std::max(0.18 / std::exp(sum / count), double{shader::kExposureMin}) : 1;
  const double result[] = {exposure, 1 / exposure, count, 0};
  for (uint32_t c = 0; c < 4; ++c) memory.at(op.output, 0, 0, c) = result[c];
}

}  // namespace xrds
