#include "shaders/radiance_ceiling/radiance_ceiling.h"

#include <algorithm>
#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

const double kFactor = shader::kCeilingFactor;

double ceilingOf(Transfer transfer, double largest) {
  return transfer == Transfer::log1p ? largest + std::log1p((kFactor - 1) * -std::expm1(-largest)) : kFactor * largest;
}

}  // namespace

TensorShape outputShape(const RadianceCeiling& op) {
  checkHolds(op.output, {1, 1, 4});
  const TensorShape shape{op.output.height, op.output.width, 4};
  checkHolds(op.input, shape);
  return shape;
}

Dispatch dispatch(const RadianceCeiling& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::RadianceCeilingParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows)};
  return imageDispatch("radiance_ceiling", device, op.output, rows, 1, params, {static_cast<uint32_t>(op.transfer)},
                       {readTexels(op.input), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const RadianceCeiling&, const DeviceTraits&) { return {}; }

void reference(const RadianceCeiling& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  constexpr int kReach = shader::kCeilingReach;
  const auto clamped = [](int64_t at, uint32_t size) {
    return static_cast<uint32_t>(std::clamp<int64_t>(at, 0, int64_t{size} - 1));
  };
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        double largest = 0;
        for (int dy = -kReach; dy <= kReach; ++dy)
          for (int dx = -kReach; dx <= kReach; ++dx)
            largest = std::max(
                largest, memory.at(op.input, clamped(int64_t{y} + dy, height), clamped(int64_t{x} + dx, width), c));
        memory.at(op.output, y, x, c) = c == 3 ? 0 : ceilingOf(op.transfer, largest);
      }
}

OperatorFacts facts(const RadianceCeiling& op) {
  return {"radiance_ceiling", {{op.input, shader::kCeilingReach}}, {1e-6, 1e-6}};
}

// Stored in fp32 always.
void propagate(const RadianceCeiling&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<RadianceCeiling>& examples) {
  examples.push_back({.input = maker.view({8, 8, 4}, DataType::f32),
                      .output = maker.view({8, 8, 4}, DataType::f32),
                      .transfer = Transfer::log1p});
}

}  // namespace xrds
