#include "shaders/encode_radiance/encode_radiance.h"

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

// The real pixel, along one axis, that a pixel of the result is of.
uint32_t realPixel(uint32_t at, uint32_t size, bool reflects) {
  if (!reflects || size == 1) return std::min(at, size - 1);
  const uint32_t last = size - 1, inPeriod = at % (2 * last);
  return std::min(inPeriod, 2 * last - inPeriod);
}

}  // namespace

TensorShape outputShape(const EncodeRadiance& op) {
  checkHolds(op.colour, {1, 1, 4});
  checkView(op.exposure, {1, 1, 4});
  checkHolds(op.output, {op.colour.height, op.colour.width, 4});
  XRDS_CHECK_LE(-1, op.albedoOffset);
  if (op.albedoOffset >= 0) {
    checkView(op.auxMean, {op.output.height, op.output.width, op.auxMean.channels});
    XRDS_CHECK_LE(op.albedoOffset + 3, static_cast<int>(op.auxMean.channels));
  }
  return {op.output.height, op.output.width, 4};
}

Dispatch dispatch(const EncodeRadiance& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  // An unread binding must still name something.
  const TensorView& auxMean = op.albedoOffset >= 0 ? op.auxMean : op.colour;
  const shader::EncodeRadianceParams params{.colour = imageOf(op.colour),
                                            .auxMean = imageOf(auxMean),
                                            .target = imageOf(op.output),
                                            .rows = targetRows(op.output, rows),
                                            .exposure = imageOf(op.exposure).offset};
  return imageDispatch(
      "encode_radiance", device, op.output, rows, 1, params,
      {static_cast<uint32_t>(op.transfer), static_cast<uint32_t>(op.albedoOffset), op.reflects},
      {readTexels(op.colour), readTexels(op.exposure), readTexels(auxMean), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const EncodeRadiance&, const DeviceTraits&) { return {}; }

void reference(const EncodeRadiance& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const double exposure = memory.at(op.exposure, 0, 0, 0);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const uint32_t fromY = realPixel(y, op.colour.height, op.reflects),
                     fromX = realPixel(x, op.colour.width, op.reflects);
      for (uint32_t c = 0; c < 3; ++c) {
        double value = memory.at(op.colour, fromY, fromX, c) * exposure;
        if (op.albedoOffset >= 0)
          value /= memory.at(op.auxMean, fromY, fromX, op.albedoOffset + c) + shader::kAlbedoEpsilon;
        memory.at(op.output, y, x, c) = transform(op.transfer, value);
      }
      memory.at(op.output, y, x, 3) = 0;
    }
}

OperatorFacts facts(const EncodeRadiance& op) {
  return {"encode_radiance", {op.colour, op.auxMean, op.exposure}, {5e-7, 5e-7}};
}

void propagate(const EncodeRadiance& op, Moments& moments) {
  for (uint32_t c = 0; c < 3; ++c) moments.at(op.output, c) = {1, 2};  // of T of radiances around mid-grey
}

void addExamples(ExampleMaker& maker, std::vector<EncodeRadiance>& examples) {
  examples.push_back({.colour = maker.view({16, 16, 4}, DataType::f32),
                      .exposure = maker.exposure(),
                      .auxMean = maker.view({16, 16, 8}, DataType::f32),
                      .output = maker.view({16, 16, 4}, DataType::f32),
                      .albedoOffset = 0,
                      .transfer = Transfer::log1p});
}

}  // namespace xrds
