#include "shaders/box_mean/box_mean.h"

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

bool isWholePixels(const TensorView& view) { return view.channels == view.channelStride; }

// The mean of one pixel, which needs no kernel.
bool isCopy(const BoxMean& op) {
  return op.scale == 1 && op.input.type == op.output.type && isWholePixels(op.input) && isWholePixels(op.output);
}

}  // namespace

TensorShape outputShape(const BoxMean& op) {
  checkView(op.input, op.input.shape());
  checkScale(op.scale);
  XRDS_CHECK_EQ(op.input.height % op.scale, 0u);
  XRDS_CHECK_EQ(op.input.width % op.scale, 0u);
  return {op.input.height / op.scale, op.input.width / op.scale, op.input.channels};
}

Dispatch dispatch(const BoxMean& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  if (isCopy(op))
    return copyRows(op.output.type == DataType::f32 ? "box_mean_copy_f32" : "box_mean_copy_f16", op.input, op.output,
                    rows);
  const shader::BoxMeanParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows)};
  return imageDispatch("box_mean", device, op.output, rows, 1, params, {op.output.channels, op.scale},
                       {readTexels(op.input), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const BoxMean&, const DeviceTraits&) { return {}; }

void reference(const BoxMean& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const uint32_t s = op.scale;
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        double sum = 0;
        for (uint32_t dy = 0; dy < s; ++dy)
          for (uint32_t dx = 0; dx < s; ++dx) sum += memory.at(op.input, y * s + dy, x * s + dx, c);
        memory.at(op.output, y, x, c) = sum / (s * s);
      }
}

OperatorFacts facts(const BoxMean& op) { return {"box_mean", {op.input}, kRoundedBudget}; }

void propagate(const BoxMean& op, Moments& moments) { moments.copy(op.input, op.output); }

void addExamples(ExampleMaker& maker, std::vector<BoxMean>& examples) {
  examples.push_back({.input = maker.view({16, 16, 8}), .output = maker.view({8, 8, 8}, DataType::f32), .scale = 2});
}

}  // namespace xrds
