#include "shaders/pack_auxiliary/pack_auxiliary.h"

#include <algorithm>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"
#include "shaders/common/transfer.h"

namespace xrds {

TensorShape outputShape(const PackAuxiliary& op) {
  checkHolds(op.input, {1, 1, 4});
  checkHolds(op.output, op.input.shape());
  XRDS_CHECK_EQ(op.output.channels, op.input.channels);
  XRDS_CHECK_LE(-1, op.albedoOffset);
  XRDS_CHECK_LE(op.albedoOffset + 3, static_cast<int>(op.input.channels));
  return op.output.shape();
}

Dispatch dispatch(const PackAuxiliary& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  const shader::PackAuxiliaryParams params{imageOf(op.input), imageOf(op.output), targetRows(op.output, rows)};
  return imageDispatch("pack_auxiliary", device, op.output, rows, 1, params,
                       {op.output.channels, static_cast<uint32_t>(op.albedoOffset)},
                       {readTexels(op.input), writeRows(op.output, rows)});
}

std::vector<float> packedWeights(const PackAuxiliary&, const DeviceTraits&) { return {}; }

void reference(const PackAuxiliary& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  const double limit = shader::kAuxiliaryMax;
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        const double value = memory.at(op.input, std::min(y, op.input.height - 1), std::min(x, op.input.width - 1), c);
        const int albedoChannel = static_cast<int>(c) - op.albedoOffset;
        const bool isAlbedo = op.albedoOffset >= 0 && albedoChannel >= 0 && albedoChannel < 3;
        memory.at(op.output, y, x, c) =
            isAlbedo ? std::clamp(value, 0.0, double{shader::kAlbedoMax}) : std::clamp(value, -limit, limit);
      }
}

OperatorFacts facts(const PackAuxiliary& op) { return {"pack_auxiliary", {op.input}, {1e-7, 4e-4}}; }

void propagate(const PackAuxiliary& op, Moments& moments) {
  for (uint32_t c = 0; c < op.output.channels; ++c) {
    const auto channel = static_cast<int>(c) - op.albedoOffset;
    const bool albedo = op.albedoOffset >= 0 && channel >= 0 && channel < 3;
    moments.at(op.output, c) = albedo ? Moment{0.5, 0.1} : Moment{0, 0.33};  // of unit vectors
  }
}

void addExamples(ExampleMaker& maker, std::vector<PackAuxiliary>& examples) {
  examples.push_back(
      {.input = maker.view({16, 16, 8}, DataType::f32), .output = maker.view({24, 24, 8}), .albedoOffset = 0});
}

}  // namespace xrds
