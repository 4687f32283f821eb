#include "shaders/exposure/exposure.h"

#include <algorithm>
#include <bit>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

// Invocations, as many as the device takes: a GPU waits for memory, a CPU does not.
uint32_t groupOf(const DeviceTraits& device) {
  const uint32_t wanted = device.family == KernelFamily::lane ? 256 : 1024;
  return std::bit_floor(std::min(wanted, device.maxGroupInvocations));
}

}  // namespace

TensorShape outputShape(const Exposure& op) {
  checkView(op.colour, {op.colour.height, op.colour.width, 4});
  XRDS_CHECK_LT(uint64_t{0}, op.colour.pixelCount());
  return {1, 1, 4};
}

Dispatch dispatch(const Exposure& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  XRDS_CHECK(op.output.type == DataType::f32);
  const shader::ExposureParams params{.source = sliceOf(op.colour),
                                      .pixelCount = static_cast<uint32_t>(op.colour.pixelCount()),
                                      .target = sliceOf(op.output).offset};
  return {.program = programName("exposure", KernelFamily::plain, op.output.type),
          .specialization = {groupOf(device), groupOf(device)},
          .bindings = {readTexels(op.colour), writeRows(op.output, {0, 1})},
          .pushConstants = pushBytes(params)};
}

std::vector<float> packedWeights(const Exposure&, const DeviceTraits&) { return {}; }

void reference(const Exposure& op, HostMemory& memory) {
  outputShape(op);
  const auto [exposure, count] = automaticExposure(op.colour.pixelCount(), [&](uint64_t i) {
    const auto y = static_cast<uint32_t>(i / op.colour.width), x = static_cast<uint32_t>(i % op.colour.width);
    return luminance(memory.at(op.colour, y, x, 0), memory.at(op.colour, y, x, 1), memory.at(op.colour, y, x, 2));
  });
  const double result[] = {exposure, 1 / exposure, static_cast<double>(count), 0};
  for (uint32_t c = 0; c < 4; ++c) memory.at(op.output, 0, 0, c) = result[c];
}

OperatorFacts facts(const Exposure& op) { return {"exposure", {op.colour}, {1e-6, 1e-6}}; }

// Stored in fp32 always.
void propagate(const Exposure&, Moments&) {}

void addExamples(ExampleMaker& maker, std::vector<Exposure>& examples) {
  examples.push_back({.colour = maker.view({16, 16, 4}, DataType::f32), .output = maker.exposure()});
}

}  // namespace xrds
