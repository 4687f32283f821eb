#include "shaders/max_pool/max_pool.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {

TensorShape outputShape(const MaxPool& op) {
  checkHolds(op.input, {2, 2, 4});
  XRDS_CHECK_EQ(op.input.height % 2, 0u);
  XRDS_CHECK_EQ(op.input.width % 2, 0u);
  return {op.input.height / 2, op.input.width / 2, op.input.channels};
}

Dispatch dispatch(const MaxPool& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::MaxPoolParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows)};
  return imageDispatch("max_pool", device, op.output, rows, 1, params, {op.output.channels},
                       {readTexels(op.input), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const MaxPool&, const DeviceTraits&) { return {}; }

void reference(const MaxPool& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        const auto of = [&](uint32_t dy, uint32_t dx) { return memory.at(op.input, 2 * y + dy, 2 * x + dx, c); };
        memory.at(op.output, y, x, c) = std::max({of(0, 0), of(0, 1), of(1, 0), of(1, 1)});
      }
}

OperatorFacts facts(const MaxPool& op) { return {"max_pool", {op.input}, kRoundedBudget}; }

void propagate(const MaxPool& op, Moments& moments) { moments.copy(op.input, op.output); }

void addExamples(ExampleMaker& maker, std::vector<MaxPool>& examples) {
  examples.push_back({.input = maker.view({16, 32, 16}), .output = maker.view({8, 16, 16})});
}

}  // namespace xrds
