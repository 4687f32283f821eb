#include "shaders/decode_frame/decode_frame.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {

TensorShape outputShape(const DecodeFrame& op) {
  checkHolds(op.output, {1, 1, 4});
  XRDS_CHECK_EQ(op.output.channels, 4u);
  checkHolds(op.input, op.output.shape());
  if (op.curve == FrameCurve::hdr) checkView(op.exposure, {1, 1, 4});
  return op.output.shape();
}

Dispatch dispatch(const DecodeFrame& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const TensorView& exposure = op.exposure.exists() ? op.exposure : op.input;  // a binding must name something
  const shader::DecodeFrameParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows),
                                         imageOf(exposure).offset};
  return imageDispatch("decode_frame", device, op.output, rows, 1, params, {static_cast<uint32_t>(op.curve)},
                       {readTexels(op.input), readTexels(exposure), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const DecodeFrame&, const DeviceTraits&) { return {}; }

void reference(const DecodeFrame& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const double inverse = op.curve == FrameCurve::hdr ? memory.at(op.exposure, 0, 0, 1) : 1;
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      bool lost = false;
      for (uint32_t c = 0; c < 3; ++c) lost |= !std::isfinite(memory.at(op.input, y, x, c));
      for (uint32_t c = 0; c < 3; ++c) {
        const double value = uncurved(op.curve, lost ? 0 : memory.at(op.input, y, x, c)) * inverse;
        memory.at(op.output, y, x, c) = std::min(value, double{shader::kFrameMax});
      }
      memory.at(op.output, y, x, 3) = lost ? 1 : 0;
    }
}

OperatorFacts facts(const DecodeFrame& op) { return {"decode_frame", {op.input, op.exposure}, {5e-6, 4e-4}}; }

// The result is stored in fp32 in any case.
void propagate(const DecodeFrame&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<DecodeFrame>& examples) {
  for (const FrameCurve curve : {FrameCurve::hdr, FrameCurve::ldr, FrameCurve::normal}) {
    DecodeFrame op{.input = maker.view({16, 16, 4}), .output = maker.view({12, 13, 4}, DataType::f32), .curve = curve};
    if (curve == FrameCurve::hdr) op.exposure = maker.exposure();
    examples.push_back(op);
  }
}

}  // namespace xrds
