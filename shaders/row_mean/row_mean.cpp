#include "shaders/row_mean/row_mean.h"

#include "shaders/common/example.h"
#include "shaders/common/groups.h"
#include "shaders/common/moments.h"

namespace xrds {

TensorShape outputShape(const RowMean& op) {
  checkView(op.input, op.input.shape());
  XRDS_CHECK_LT(0u, op.input.width);
  return {op.input.height, 1, op.input.channels};
}

Dispatch dispatch(const RowMean& op, const DeviceTraits&) {
  checkView(op.output, outputShape(op));
  XRDS_CHECK(op.output.type == DataType::f32);
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::RowMeanParams params{.source = sliceOf(op.input),
                                     .target = sliceOf(op.output),
                                     .width = op.input.width,
                                     .rowBegin = rows.begin,
                                     .rowEnd = rows.end,
                                     .storeOrigin = storeOrigin(op.output, rows)};
  const uint32_t quads = op.input.channels / 4;
  return {.program = programName("row_mean", KernelFamily::plain, op.output.type),
          .specialization = {quads},
          .bindings = {readTexels(op.input), writeRows(op.output, rows)},
          .pushConstants = pushBytes(params),
          .groupCount = foldedGroups(ceilDivide(uint64_t{rows.end - rows.begin} * quads, shader::kRowMeanGroup))};
}

std::vector<float> packedWeights(const RowMean&, const DeviceTraits&) { return {}; }

void reference(const RowMean& op, HostMemory& memory) {
  const auto [height, one, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t c = 0; c < channels; ++c) {
      double sum = 0;
      for (uint32_t x = 0; x < op.input.width; ++x) sum += memory.at(op.input, y, x, c);
      memory.at(op.output, y, 0, c) = sum / op.input.width;
    }
}

OperatorFacts facts(const RowMean& op) { return {"row_mean", {{op.input, kWholeImage}}, {2e-6, 2e-6}}; }

// Neighbouring pixels count as equal, so the mean varies as they do. Stored in fp32 always.
void propagate(const RowMean& op, Moments& moments) { moments.copy(op.input, op.output); }

void addExamples(ExampleMaker& maker, std::vector<RowMean>& examples) {
  examples.push_back({.input = maker.view({16, 16, 32}), .output = maker.view({16, 1, 32}, DataType::f32)});
}

}  // namespace xrds
