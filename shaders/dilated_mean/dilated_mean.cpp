#include "shaders/dilated_mean/dilated_mean.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {

TensorShape outputShape(const DilatedMean& op) {
  checkHolds(op.output, {1, 1, 4});
  XRDS_CHECK_EQ(op.output.channels, op.input.channels);
  XRDS_CHECK_LE(1u, op.step);
  checkHolds(op.input, op.output.shape());
  return op.output.shape();
}

Dispatch dispatch(const DilatedMean& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::DilatedMeanParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows)};
  return imageDispatch("dilated_mean", device, op.output, rows, 1, params, {op.output.channels, op.step},
                       {readTexels(op.input), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const DilatedMean&, const DeviceTraits&) { return {}; }

void reference(const DilatedMean& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const auto inside = [](int64_t at, uint32_t size) {
    return static_cast<uint32_t>(std::clamp<int64_t>(at, 0, size - 1));
  };
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        double sum = 0;
        for (int64_t j = 0; j < 9; ++j)
          sum += memory.at(op.input, inside(y + op.step * (j / 3 - 1), height),
                           inside(x + op.step * (j % 3 - 1), width), c);
        memory.at(op.output, y, x, c) = sum / 9;
      }
}

OperatorFacts facts(const DilatedMean& op) { return {"dilated_mean", {{op.input, op.step}}, kRoundedBudget}; }

void propagate(const DilatedMean& op, Moments& moments) { moments.copy(op.input, op.output); }

void addExamples(ExampleMaker& maker, std::vector<DilatedMean>& examples) {
  examples.push_back(
      {.input = maker.view({16, 16, 8}, DataType::f32), .output = maker.view({12, 13, 8}, DataType::f32), .step = 3});
}

}  // namespace xrds
