#include "shaders/encode_frame/encode_frame.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

uint32_t guideCount(const EncodeFrame& op) { return op.guides.exists() ? op.guides.channels / 4 : 0; }

}  // namespace

TensorShape outputShape(const EncodeFrame& op) {
  checkHolds(op.input, {1, 1, 4});
  if (op.guides.exists()) {
    XRDS_CHECK_LE(op.guides.channels, 8u);
    checkView(op.guides, {op.input.height, op.input.width, op.guides.channels});
  }
  if (op.curve == FrameCurve::hdr) checkView(op.exposure, {1, 1, 4});
  checkHolds(op.output, {op.input.height, op.input.width, 4});
  XRDS_CHECK_EQ(op.output.channels, alignUp(3 + 3 * guideCount(op), 4));
  return op.output.shape();
}

Dispatch dispatch(const EncodeFrame& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  // An unread binding must still name something.
  const TensorView& guides = op.guides.exists() ? op.guides : op.input;
  const TensorView& exposure = op.exposure.exists() ? op.exposure : op.input;
  const shader::EncodeFrameParams params{imageOf(op.input), imageOf(guides), imageOf(op.output),
                                         targetRows(op.output, rows), imageOf(exposure).offset};
  return imageDispatch("encode_frame", device, op.output, rows, 1, params,
                       {static_cast<uint32_t>(op.curve), guideCount(op)},
                       {readTexels(op.input), readTexels(guides), readTexels(exposure), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const EncodeFrame&, const DeviceTraits&) { return {}; }

void reference(const EncodeFrame& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const double exposure = op.curve == FrameCurve::hdr ? memory.at(op.exposure, 0, 0, 0) : 1;
  const auto seen = [&](uint32_t y, uint32_t x, uint32_t c) {
    if (y >= op.input.height || x >= op.input.width || c >= 3 + 3 * guideCount(op)) return 0.0;
    if (c < 3) return curved(op.curve, exposure * memory.at(op.input, y, x, c));
    const double guide = memory.at(op.guides, y, x, c - 3);
    if (c >= 6) return curved(FrameCurve::normal, guide);
    return std::isnan(guide) ? 0 : std::clamp(guide, 0.0, 1.0);
  };
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) memory.at(op.output, y, x, c) = seen(y, x, c);
}

OperatorFacts facts(const EncodeFrame& op) {
  return {"encode_frame", {op.input, op.guides, op.exposure}, {2e-6, 4e-4}};
}

void propagate(const EncodeFrame& op, Moments& moments) {
  constexpr Moment kSeen{0.4, 0.06};  // of values from 0 to 1
  for (uint32_t c = 0; c < 3 + 3 * guideCount(op); ++c) moments.at(op.output, c) = kSeen;
}

void addExamples(ExampleMaker& maker, std::vector<EncodeFrame>& examples) {
  const auto make = [&](FrameCurve curve, uint32_t guides) {
    EncodeFrame op{.input = maker.view({12, 13, 4}, DataType::f32)};
    if (guides > 0) op.guides = maker.view({12, 13, 4 * guides}, DataType::f32);
    if (curve == FrameCurve::hdr) op.exposure = maker.exposure();
    op.output = maker.view({16, 16, 4 + 4 * guides});
    op.curve = curve;
    return op;
  };
  examples = {make(FrameCurve::hdr, 2), make(FrameCurve::ldr, 1), make(FrameCurve::normal, 0)};
}

}  // namespace xrds
