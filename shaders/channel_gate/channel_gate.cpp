#include "shaders/channel_gate/channel_gate.h"

#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/moments.h"

namespace xrds {
namespace {

uint32_t squeezed(const ChannelGate& op) { return static_cast<uint32_t>(op.bias.size()); }

}  // namespace

TensorShape outputShape(const ChannelGate& op) {
  constexpr uint32_t kMostChannels = 512;  // in shared memory
  checkView(op.input, {op.input.height, 1, op.input.channels});
  XRDS_CHECK(op.input.type == DataType::f32);
  XRDS_CHECK_LT(0u, op.input.height);
  XRDS_CHECK_LE(op.input.channels, kMostChannels);
  XRDS_CHECK_LT(0u, squeezed(op));
  XRDS_CHECK_LE(squeezed(op), op.input.channels);
  XRDS_CHECK_EQ(op.weight.size(), size_t{squeezed(op)} * op.input.channels);
  XRDS_CHECK_EQ(op.upWeight.size(), op.weight.size());
  XRDS_CHECK_EQ(op.upBias.size(), size_t{op.input.channels});
  return {1, 1, op.input.channels};
}

Dispatch dispatch(const ChannelGate& op, const DeviceTraits&) {
  checkView(op.output, outputShape(op));
  XRDS_CHECK(op.output.type == DataType::f32);
  const shader::ChannelGateParams params{sliceOf(op.input), sliceOf(op.output), op.input.height};
  return {.program = programName("channel_gate", KernelFamily::plain, op.output.type),
          .specialization = {op.input.channels, squeezed(op)},
          .bindings = {readTexels(op.input), readWeights(DataType::f32), writeRows(op.output, {0, 1})},
          .pushConstants = pushBytes(params),
          .multiplyAdds = 2 * op.weight.size()};
}

std::vector<float> packedWeights(const ChannelGate& op, const DeviceTraits&) {
  const uint32_t channels = op.input.channels, few = squeezed(op);
  std::vector<float> packed(op.weight.begin(), op.weight.end());
  packed.insert(packed.end(), op.bias.begin(), op.bias.end());
  packed.resize(packed.size() + alignUp(few, 4) - few);
  for (uint32_t j = 0; j < few; ++j)
    for (uint32_t c = 0; c < channels; ++c) packed.push_back(op.upWeight[size_t{c} * few + j]);
  packed.insert(packed.end(), op.upBias.begin(), op.upBias.end());
  return packed;
}

void reference(const ChannelGate& op, HostMemory& memory) {
  const uint32_t channels = outputShape(op).channels, few = squeezed(op);
  std::vector<double> means(channels), hidden(op.bias.begin(), op.bias.end());
  for (uint32_t c = 0; c < channels; ++c)
    for (uint32_t y = 0; y < op.input.height; ++y) means[c] += memory.at(op.input, y, 0, c) / op.input.height;
  for (uint32_t j = 0; j < few; ++j) {
    for (uint32_t c = 0; c < channels; ++c) hidden[j] += op.weight[size_t{j} * channels + c] * means[c];
    hidden[j] = std::max(hidden[j], 0.0);
  }
  for (uint32_t c = 0; c < channels; ++c) {
    double sum = op.upBias[c];
    for (uint32_t j = 0; j < few; ++j) sum += op.upWeight[size_t{c} * few + j] * hidden[j];
    memory.at(op.output, 0, 0, c) = 1 / (1 + std::exp(-sum));
  }
}

OperatorFacts facts(const ChannelGate& op) {
  return {"channel_gate", {{op.input, kWholeImage}}, {2e-6, 2e-6}, 2 * op.weight.size()};
}

// Between 0 and 1, whatever goes in. Stored in fp32 always.
void propagate(const ChannelGate& op, Moments& moments) {
  for (uint32_t c = 0; c < op.output.channels; ++c) moments.at(op.output, c) = {0.5, 0};
}

void addExamples(ExampleMaker& maker, std::vector<ChannelGate>& examples) {
  constexpr uint32_t kChannels = 32, kSqueezed = 2;
  examples.push_back({.input = maker.view({16, 1, kChannels}, DataType::f32),
                      .output = maker.view({1, 1, kChannels}, DataType::f32),
                      .weight = maker.weights(kSqueezed * kChannels),
                      .bias = maker.weights(kSqueezed),
                      .upWeight = maker.weights(kSqueezed * kChannels),
                      .upBias = maker.weights(kChannels)});
}

}  // namespace xrds
