#include "shaders/decode_radiance/decode_radiance.h"

#include <algorithm>
#include <bit>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {

TensorShape outputShape(const DecodeRadiance& op) {
  checkHolds(op.output, {1, 1, 4});
  const TensorShape shape{op.output.height, op.output.width, 4};
  XRDS_CHECK(op.network.exists() || op.base.exists());
  if (op.network.exists()) checkHolds(op.network, shape);
  checkView(op.exposure, {1, 1, 4});
  XRDS_CHECK_LE(-1, op.albedoOffset);
  if (op.base.exists()) checkHolds(op.base, shape);
  if (op.ceiling.exists()) {
    checkScale(op.scale);
    checkHolds(op.ceiling, {ceilDivide(shape.height, op.scale), ceilDivide(shape.width, op.scale), 4});
  }
  if (op.colour.exists()) checkHolds(op.colour, shape);
  if (op.albedoOffset >= 0) checkHolds(op.aux, {shape.height, shape.width, op.albedoOffset + 3u});
  return shape;
}

Dispatch dispatch(const DecodeRadiance& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  // An unread binding must still name something.
  const TensorView& network = op.network.exists() ? op.network : op.base;
  const TensorView& base = op.base.exists() ? op.base : op.network;
  const TensorView& ceiling = op.ceiling.exists() ? op.ceiling : network;
  const TensorView& aux = op.albedoOffset >= 0 ? op.aux : network;
  const TensorView& colour = op.colour.exists() ? op.colour : network;
  const shader::DecodeRadianceParams params{.network = imageOf(network),
                                            .base = imageOf(base),
                                            .ceiling = imageOf(ceiling),
                                            .aux = imageOf(aux),
                                            .colour = imageOf(colour),
                                            .target = imageOf(op.output),
                                            .rows = targetRows(op.output, rows),
                                            .exposure = imageOf(op.exposure).offset};
  return imageDispatch("decode_radiance", device, op.output, rows, 1, params,
                       {static_cast<uint32_t>(op.transfer), static_cast<uint32_t>(op.albedoOffset), op.base.exists(),
                        op.network.exists(), op.ceiling.exists() ? op.scale : 0, op.colour.exists(),
                        std::bit_cast<uint32_t>(op.darker), std::bit_cast<uint32_t>(op.brighter)},
                       {readTexels(network), readTexels(base), readTexels(ceiling), readTexels(aux), readTexels(colour),
                        readTexels(op.exposure), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const DecodeRadiance&, const DeviceTraits&) { return {}; }

void reference(const DecodeRadiance& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const double exposure = memory.at(op.exposure, 0, 0, 0), limit = shader::kRadianceMax;
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      double raw[3] = {};
      for (uint32_t c = 0; op.network.exists() && c < 3; ++c) raw[c] = memory.at(op.network, y, x, c);
      const bool lost = !std::all_of(raw, raw + 3, [](double value) { return std::isfinite(value); });
      for (uint32_t c = 0; c < 3; ++c) {
        double value = lost ? 0 : raw[c];
        if (op.base.exists()) {
          const double base = memory.at(op.base, y, x, c);
          double most = shader::kTransformedMax;
          if (op.ceiling.exists()) most = std::min(most, memory.at(op.ceiling, y / op.scale, x / op.scale, c));
          value = std::clamp(base + value, 0.0, std::max(base, most));
        }
        value = inverseTransform(op.transfer, value);
        if (op.albedoOffset >= 0) value *= memory.at(op.aux, y, x, op.albedoOffset + c) + shader::kAlbedoEpsilon;
        value = std::clamp(value / exposure, -limit, limit);
        if (op.colour.exists()) {
          const double colour = std::max(memory.at(op.colour, y, x, c), 0.0),
                       share = value < colour ? op.darker : op.brighter;
          value = share * value + (1 - share) * colour;
        }
        memory.at(op.output, y, x, c) = value;
      }
      memory.at(op.output, y, x, 3) = lost ? 1 : 0;
    }
}

OperatorFacts facts(const DecodeRadiance& op) {
  return {"decode_radiance", {op.network, op.base, op.ceiling, op.aux, op.colour, op.exposure}, {1e-6, 1e-6}};
}

// Stored in fp32 always.
void propagate(const DecodeRadiance&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<DecodeRadiance>& examples) {
  examples.push_back({.network = maker.view({16, 16, 4}),
                      .base = maker.view({16, 16, 4}, DataType::f32),
                      .ceiling = maker.view({8, 8, 4}, DataType::f32),
                      .aux = maker.view({16, 16, 8}),
                      .exposure = maker.exposure(),
                      .output = maker.view({16, 16, 4}, DataType::f32),
                      .albedoOffset = 0,
                      .transfer = Transfer::log1p,
                      .scale = 2});
  examples.push_back({.network = maker.view({16, 16, 4}),
                      .base = maker.view({16, 16, 4}, DataType::f32),
                      .colour = maker.view({16, 16, 4}, DataType::f32),
                      .exposure = maker.exposure(),
                      .output = maker.view({16, 16, 4}, DataType::f32),
                      .transfer = Transfer::log1p,
                      .darker = 0.75F,
                      .brighter = 0.25F});
}

}  // namespace xrds
