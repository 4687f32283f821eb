#include "shaders/box_sum/box_sum.h"

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
TensorShape outputShape(const BoxSum& op) {
  checkView(op.input, op.input.shape());
  checkScale(op.scale);
  XRDS_CHECK_EQ(op.input.height % op.scale, 0u);
  XRDS_CHECK_EQ(op.input.width % op.scale, 0u);
  return {op.input.height / op.scale, op.input.width / op.scale, op.input.channels};
}

Dispatch dispatch(const BoxSum& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::BoxSumParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows)};
  return imageDispatch("box_sum", device, op.output, rows, 1, params, {op.output.channels, op.scale},
                       {readTexels(op.input), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const BoxSum&, const DeviceTraits&) { return {}; }

void reference(const BoxSum& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const uint32_t s = op.scale;
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        double sum = 0;
        for (uint32_t dy = 0; dy < s; ++dy)
          for (uint32_t dx = 0; dx < s; ++dx) sum += memory.at(op.input, y * s + dy, x * s + dx, c);
        memory.at(op.output, y, x, c) = sum;
      }
}

OperatorFacts facts(const BoxSum& op) { return {"box_sum", {op.input}, kRoundedBudget}; }

void propagate(const BoxSum& op, Moments& moments) {
  const double pixels = op.scale * op.scale;
  for (uint32_t c = 0; c < op.output.channels; ++c) {
    const Moment x = moments.at(op.input, c);
    moments.at(op.output, c) = {pixels * x.mean, pixels * pixels * x.variance};
  }
}

void addExamples(ExampleMaker& maker, std::vector<BoxSum>& examples) {
  examples.push_back({.input = maker.view({16, 16, 8}), .output = maker.view({8, 8, 8}, DataType::f32), .scale = 2});
}

}  // namespace xrds
