#include "shaders/decode_radiance/decode_radiance.h"

namespace xrds {
namespace {

// Channel c of the albedo that the pixel is multiplied with.
double albedo(const DecodeRadiance& op, const HostMemory& memory, uint32_t y, uint32_t x, uint32_t c) {
  if (op.albedoKernels == 0) return memory.at(op.aux, y, x, op.albedoOffset + c);
  const int side = static_cast<int>(op.albedoKernels);
  double sum = 0, total = 0;
  for (int j = 0; j < side * side; ++j) {
    const int ny = static_cast<int>(y) + j / side - side / 2, nx = static_cast<int>(x) + j % side - side / 2;
    const double limit = shader::kLogitMax;
    const double weight = std::exp(std::clamp(memory.at(op.network, y, x, op.firstAlbedoLogit + j), -limit, limit));
    sum += weight * memory.at(op.aux, std::clamp<int>(ny, 0, op.output.height - 1),
                              std::clamp<int>(nx, 0, op.output.width - 1), op.albedoOffset + c);
    total += weight;
  }
  return sum / total;
}

}  // namespace

TensorShape outputShape(const DecodeRadiance& op) {
  checkHolds(op.output, {1, 1, 4});
  const TensorShape shape{op.output.height, op.output.width, 4};
  XRDS_CHECK(op.network.exists() || op.base.exists());
  if (op.network.exists()) checkHolds(op.network, shape);
  checkView(op.exposure, {1, 1, 4});
  XRDS_CHECK_LE(-1, op.albedoOffset);
  if (op.base.exists()) checkHolds(op.base, shape);
  if (op.albedoOffset >= 0) checkHolds(op.aux, {shape.height, shape.width, op.albedoOffset + 3u});
  if (op.albedoKernels > 0) {
    XRDS_CHECK_EQ(op.albedoKernels % 2, 1u);
    XRDS_CHECK_LE(0, op.albedoOffset);
    checkHolds(op.network, {shape.height, shape.width, op.firstAlbedoLogit + op.albedoKernels * op.albedoKernels});
  }
  return shape;
}

Dispatch dispatch(const DecodeRadiance& op, const DeviceTraits&) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  // An unread binding must still name something.
  const TensorView& network = op.network.exists() ? op.network : op.base;
  const TensorView& base = op.base.exists() ? op.base : op.network;
  const TensorView& aux = op.albedoOffset >= 0 ? op.aux : network;
  const shader::DecodeRadianceParams params{.network = imageOf(network),
                                            .base = imageOf(base),
                                            .aux = imageOf(aux),
                                            .target = imageOf(op.output),
                                            .rows = targetRows(op.output, rows),
                                            .exposure = imageOf(op.exposure).offset};
  return {.program = programName("decode_radiance", KernelFamily::plain, op.output.type),
          .specialization = {static_cast<uint32_t>(op.transfer), static_cast<uint32_t>(op.albedoOffset),
                             op.base.exists(), op.network.exists(), op.albedoKernels, op.firstAlbedoLogit},
          .bindings = {readTexels(network), readTexels(base), readTexels(aux), readTexels(op.exposure),
                       writeRows(op.output, rows)},
          .pushConstants = pushBytes(params),
          .groupCount = imageGroups(op.output.width, rows.end - rows.begin)};
}

std::vector<float> packedWeights(const DecodeRadiance&, const DeviceTraits&) { return {}; }

void reference(const DecodeRadiance& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const double exposure = memory.at(op.exposure, 0, 0, 0);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      for (uint32_t c = 0; c < 3; ++c) {
        double value = op.network.exists() ? memory.at(op.network, y, x, c) : 0;
        if (op.base.exists())
          value = std::clamp(memory.at(op.base, y, x, c) + value, 0.0, double{shader::kTransformedMax});
        value = inverseTransform(op.transfer, value);
        if (op.albedoOffset >= 0) value *= albedo(op, memory, y, x, c) + shader::kAlbedoEpsilon;
        memory.at(op.output, y, x, c) = value / exposure;
      }
      memory.at(op.output, y, x, 3) = 0;
    }
}

}  // namespace xrds
