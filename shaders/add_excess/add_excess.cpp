#include "shaders/add_excess/add_excess.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {

TensorShape outputShape(const AddExcess& op) {
  const TensorShape shape{op.image.height, op.image.width, 4};
  checkView(op.image, shape);
  checkView(op.input, shape);
  return shape;
}

Dispatch dispatch(const AddExcess& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::AddExcessParams params{imageOf(op.input), imageOf(op.image), imageOf(op.output),
                                       targetRows(op.output, rows)};
  return imageDispatch("add_excess", device, op.output, rows, 1, params, {},
                       {readTexels(op.input), readTexels(op.image), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const AddExcess&, const DeviceTraits&) { return {}; }

void reference(const AddExcess& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        const double number = memory.at(op.image, y, x, c);
        memory.at(op.output, y, x, c) = memory.at(op.input, y, x, c) + number - std::clamp(number, 0.0, 1.0);
      }
}

OperatorFacts facts(const AddExcess& op) { return {"add_excess", {op.input, op.image}, kRoundedBudget}; }

// Stored in fp32 always.
void propagate(const AddExcess&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<AddExcess>& examples) {
  examples.push_back({.input = maker.view({8, 12, 4}, DataType::f32),
                      .image = maker.view({8, 12, 4}, DataType::f32, {-1, 3}),
                      .output = maker.view({8, 12, 4}, DataType::f32)});
}

}  // namespace xrds
