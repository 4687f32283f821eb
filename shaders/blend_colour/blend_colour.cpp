#include "shaders/blend_colour/blend_colour.h"

#include <algorithm>
#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

// How many pixels of a column share the loads of their neighbours.
constexpr uint32_t kRun = 4;

uint32_t neighboursOf(const BlendColour& op) { return op.kernelSide * op.kernelSide; }

void referencePixel(const BlendColour& op, HostMemory& memory, uint32_t y, uint32_t x) {
  const auto side = static_cast<int64_t>(op.kernelSide);
  const double limit = shader::kLogitMax;
  double colour[3] = {}, albedo[3] = {}, total = 0;
  for (int64_t j = 0; j < side * side; ++j) {
    const auto ny = static_cast<uint32_t>(std::clamp<int64_t>(y + j / side - side / 2, 0, op.output.height - 1));
    const auto nx = static_cast<uint32_t>(std::clamp<int64_t>(x + j % side - side / 2, 0, op.output.width - 1));
    const double logit = memory.at(op.network, y, x, op.firstLogit + static_cast<uint32_t>(j));
    const double weight = std::exp(std::clamp(logit, -limit, limit));
    for (uint32_t c = 0; c < 3; ++c) {
      colour[c] += weight * std::max(memory.at(op.images, ny, nx, static_cast<uint32_t>(op.colourOffset) + c), 0.0);
      albedo[c] += weight * memory.at(op.aux, ny, nx, static_cast<uint32_t>(op.albedoOffset) + c);
    }
    total += weight;
  }
  const double shareLimit = shader::kShareLogitMax;
  const double logit = memory.at(op.network, y, x, op.firstLogit + neighboursOf(op));
  const double share = 1 / (1 + std::exp(-std::clamp(logit, -shareLimit, shareLimit)));
  const double exposure = memory.at(op.exposure, 0, 0, 0);
  for (uint32_t c = 0; c < 3; ++c) {
    const double found =
        transform(op.transfer, exposure * (colour[c] / total) / (albedo[c] / total + shader::kAlbedoEpsilon));
    memory.at(op.output, y, x, c) = (1 - share) * memory.at(op.base, y, x, c) + share * found;
  }
  memory.at(op.output, y, x, 3) = 0;
}

}  // namespace

TensorShape outputShape(const BlendColour& op) {
  checkHolds(op.output, {1, 1, 4});
  XRDS_CHECK_EQ(op.kernelSide % 2, 1u);
  XRDS_CHECK_LE(0, op.colourOffset);
  XRDS_CHECK_LE(0, op.albedoOffset);
  const auto holds = [&](const TensorView& view, uint32_t channels) {
    checkHolds(view, {op.output.height, op.output.width, channels});
  };
  holds(op.base, 4);
  holds(op.images, static_cast<uint32_t>(op.colourOffset) + 3);
  holds(op.aux, static_cast<uint32_t>(op.albedoOffset) + 3);
  holds(op.network, op.firstLogit + neighboursOf(op) + 1);
  checkView(op.exposure, {1, 1, 4});
  return {op.output.height, op.output.width, 4};
}

Dispatch dispatch(const BlendColour& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::BlendColourParams params{.base = imageOf(op.base),
                                         .images = imageOf(op.images),
                                         .aux = imageOf(op.aux),
                                         .network = imageOf(op.network),
                                         .target = imageOf(op.output),
                                         .rows = targetRows(op.output, rows),
                                         .exposure = imageOf(op.exposure).offset};
  return imageDispatch("blend_colour", device, op.output, rows, kRun, params,
                       {op.kernelSide, op.firstLogit, static_cast<uint32_t>(op.colourOffset),
                        static_cast<uint32_t>(op.albedoOffset), static_cast<uint32_t>(op.transfer), kRun},
                       {readTexels(op.base), readTexels(op.images), readTexels(op.aux), readTexels(op.network),
                        readTexels(op.exposure), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const BlendColour&, const DeviceTraits&) { return {}; }

void reference(const BlendColour& op, HostMemory& memory) {
  outputShape(op);
  const RowRange rows = resolve(op.rows, op.output.height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < op.output.width; ++x) referencePixel(op, memory, y, x);
}

OperatorFacts facts(const BlendColour& op) {
  const uint32_t around = op.kernelSide / 2;
  return {"blend_colour", {op.base, {op.images, around}, {op.aux, around}, op.network, op.exposure}, {1e-6, 1e-6}};
}

// Stored in fp32 always.
void propagate(const BlendColour&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<BlendColour>& examples) {
  examples.push_back({.base = maker.view({16, 16, 4}, DataType::f32),
                      .images = maker.view({16, 16, 12}, DataType::f32),
                      .aux = maker.view({16, 16, 12}),
                      .network = maker.view({16, 16, 16}),
                      .exposure = maker.exposure(),
                      .output = maker.view({16, 16, 4}, DataType::f32),
                      .colourOffset = 6,
                      .kernelSide = 3,
                      .firstLogit = 3,
                      .transfer = Transfer::log1p});
}

}  // namespace xrds
