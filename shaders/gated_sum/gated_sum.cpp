#include "shaders/gated_sum/gated_sum.h"

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {

TensorShape outputShape(const GatedSum& op) {
  checkView(op.input, op.input.shape());
  if (op.gate.exists()) {
    checkView(op.gate, {1, 1, op.input.channels});
    XRDS_CHECK(op.gate.type == DataType::f32);
  }
  return op.input.shape();
}

Dispatch dispatch(const GatedSum& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  checkView(op.addend, op.output.shape());
  const RowRange rows = resolve(op.rows, op.output.height);
  const uint32_t hasGate = op.gate.exists();
  const TensorView& gate = hasGate ? op.gate : op.input;  // bound, not read
  const shader::GatedSumParams params{imageOf(op.input), imageOf(op.addend), imageOf(op.output),
                                      targetRows(op.output, rows), sliceOf(gate).offset};
  return imageDispatch("gated_sum", device, op.output, rows, 1, params, {op.output.channels, hasGate},
                       {readTexels(op.input), writeRows(op.output, rows), readTexels(op.addend), readTexels(gate)});
}

std::vector<float> packedWeights(const GatedSum&, const DeviceTraits&) { return {}; }

void reference(const GatedSum& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c)
        memory.at(op.output, y, x, c) =
            memory.at(op.input, y, x, c) * (op.gate.exists() ? memory.at(op.gate, 0, 0, c) : 1) +
            memory.at(op.addend, y, x, c);
}

OperatorFacts facts(const GatedSum& op) { return {"gated_sum", {op.input, op.gate, op.addend}, kRoundedBudget}; }

void propagate(const GatedSum& op, Moments& moments) {
  for (uint32_t c = 0; c < op.output.channels; ++c) {
    const Moment x = moments.at(op.input, c);
    const double gate = op.gate.exists() ? moments.at(op.gate, c).mean : 1;
    moments.at(op.output, c) =
        moments.finished({gate * x.mean, gate * gate * x.variance}, Activation::none, op.addend, c);
  }
}

void addExamples(ExampleMaker& maker, std::vector<GatedSum>& examples) {
  GatedSum gated{.input = maker.view({16, 16, 32}), .output = maker.view({16, 16, 32})};
  gated.addend = maker.view({16, 16, 32});
  GatedSum plain = gated;
  gated.gate = maker.view({1, 1, 32}, DataType::f32);
  examples = {gated, plain};
}

}  // namespace xrds
