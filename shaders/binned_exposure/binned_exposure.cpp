#include "shaders/binned_exposure/binned_exposure.h"

#include <algorithm>
#include <bit>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {

TensorShape outputShape(const BinnedExposure& op) {
  checkView(op.colour, {op.colour.height, op.colour.width, 4});
  XRDS_CHECK_LT(uint64_t{0}, op.colour.pixelCount());
  return {1, 1, 4};
}

Dispatch dispatch(const BinnedExposure& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  XRDS_CHECK(op.output.type == DataType::f32);
  const auto bins = [](uint32_t size) { return static_cast<int>(ceilDivide(size, uint32_t{shader::kExposureBin})); };
  const shader::BinnedExposureParams params{.source = sliceOf(op.colour),
                                            .height = static_cast<int>(op.colour.height),
                                            .width = static_cast<int>(op.colour.width),
                                            .rows = bins(op.colour.height),
                                            .columns = bins(op.colour.width),
                                            .target = sliceOf(op.output).offset};
  const uint32_t group = std::bit_floor(std::min(shader::kBinnedExposureGroup, device.maxGroupInvocations));
  return {.program = programName("binned_exposure", KernelFamily::plain, op.output.type),
          .specialization = {group, group},
          .bindings = {readTexels(op.colour), writeRows(op.output, {0, 1})},
          .pushConstants = pushBytes(params)};
}

std::vector<float> packedWeights(const BinnedExposure&, const DeviceTraits&) { return {}; }

void reference(const BinnedExposure& op, HostMemory& memory) {
  outputShape(op);
  const auto [exposure, count] =
      binnedExposureOf(op.colour.height, op.colour.width,
                       [&](uint32_t y, uint32_t x, uint32_t c) { return memory.at(op.colour, y, x, c); });
  const double result[] = {exposure, 1 / exposure, static_cast<double>(count), 0};
  for (uint32_t c = 0; c < 4; ++c) memory.at(op.output, 0, 0, c) = result[c];
}

OperatorFacts facts(const BinnedExposure& op) { return {"binned_exposure", {{op.colour, kWholeImage}}, {2e-6, 2e-6}}; }

// Stored in fp32 always.
void propagate(const BinnedExposure&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<BinnedExposure>& examples) {
  examples.push_back({.colour = maker.view({40, 36, 4}, DataType::f32), .output = maker.exposure()});
}

}  // namespace xrds
