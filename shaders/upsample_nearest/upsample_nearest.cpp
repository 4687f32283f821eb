#include "shaders/upsample_nearest/upsample_nearest.h"

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {

TensorShape outputShape(const UpsampleNearest& op) {
  checkHolds(op.input, {1, 1, 4});
  return {2 * op.input.height, 2 * op.input.width, op.input.channels};
}

Dispatch dispatch(const UpsampleNearest& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::UpsampleNearestParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows)};
  return imageDispatch("upsample_nearest", device, op.output, rows, 1, params, {op.output.channels},
                       {readTexels(op.input), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const UpsampleNearest&, const DeviceTraits&) { return {}; }

void reference(const UpsampleNearest& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) memory.at(op.output, y, x, c) = memory.at(op.input, y / 2, x / 2, c);
}

OperatorFacts facts(const UpsampleNearest& op) { return {"upsample_nearest", {op.input}, kRoundedBudget}; }

void propagate(const UpsampleNearest& op, Moments& moments) { moments.copy(op.input, op.output); }

void addExamples(ExampleMaker& maker, std::vector<UpsampleNearest>& examples) {
  examples.push_back({.input = maker.view({8, 16, 16}), .output = maker.view({16, 32, 16})});
}

}  // namespace xrds
