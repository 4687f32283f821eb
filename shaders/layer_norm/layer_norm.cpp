#include "shaders/layer_norm/layer_norm.h"

#include <cmath>

#include "shaders/common/example.h"
#include "shaders/common/groups.h"
#include "shaders/common/moments.h"
#include "shaders/common/tile.h"

namespace xrds {
namespace {

// Invocations that share a token in the tile kernel; 0: the device takes the plain one.
uint32_t tileShare(const LayerNorm& op, const DeviceTraits& device) {
  constexpr uint32_t kMaxTexels = 16;  // of an invocation, in registers
  const uint32_t share = tileColumns(op.input.channels / 4);
  return takesTiles(device) && op.input.channels / 4 <= kMaxTexels * share ? share : 0;
}

}  // namespace

TensorShape outputShape(const LayerNorm& op) {
  checkView(op.input, op.input.shape());
  XRDS_CHECK_EQ(op.weight.size(), size_t{op.input.channels});
  XRDS_CHECK_EQ(op.bias.size(), size_t{op.input.channels});
  return op.input.shape();
}

Dispatch dispatch(const LayerNorm& op, const DeviceTraits& device) {
  checkView(op.output, outputShape(op));
  const RowRange rows = resolve(op.rows, op.output.height);
  shader::LayerNormParams params{};
  params.source = sliceOf(op.input);
  params.target = sliceOf(op.output);
  params.tokenBegin = rows.begin * op.input.width;
  params.tokenEnd = rows.end * op.input.width;
  params.storeOrigin = storeOrigin(op.output, rows);
  params.epsilon = op.epsilon;
  const uint32_t channels = op.input.channels, tokens = params.tokenEnd - params.tokenBegin;
  Dispatch launch{.bindings = {readTexels(op.input), readWeights(DataType::f32), writeRows(op.output, rows)},
                  .pushConstants = pushBytes(params)};
  if (const uint32_t share = tileShare(op, device)) {
    launch.program = programName("layer_norm", KernelFamily::tile, op.output.type);
    launch.specialization = {share, kTileInvocations / share, channels, share, kTileInvocations / share};
    launch.groupCount = foldedGroups(ceilDivide(tokens, kTileInvocations / share));
  } else {
    launch.program = programName("layer_norm", KernelFamily::plain, op.output.type);
    launch.specialization = {channels};
    launch.groupCount = foldedGroups(ceilDivide(tokens, 64));
  }
  return launch;
}

std::vector<float> packedWeights(const LayerNorm& op, const DeviceTraits&) {
  std::vector<float> packed(op.weight.begin(), op.weight.end());
  packed.insert(packed.end(), op.bias.begin(), op.bias.end());
  return packed;
}

void reference(const LayerNorm& op, HostMemory& memory) {
  const auto [height, width, channels] = outputShape(op);
  const RowRange rows = resolve(op.rows, height);
  for (uint32_t y = rows.begin; y < rows.end; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      double mean = 0, variance = 0;
      for (uint32_t c = 0; c < channels; ++c) mean += memory.at(op.input, y, x, c) / channels;
      for (uint32_t c = 0; c < channels; ++c) variance += std::pow(memory.at(op.input, y, x, c) - mean, 2) / channels;
      const double scale = 1 / std::sqrt(variance + op.epsilon);
      for (uint32_t c = 0; c < channels; ++c)
        memory.at(op.output, y, x, c) = (memory.at(op.input, y, x, c) - mean) * scale * op.weight[c] + op.bias[c];
    }
}

OperatorFacts facts(const LayerNorm& op) { return {"layer_norm", {op.input}, {1e-6, 4e-4}}; }

void propagate(const LayerNorm& op, Moments& moments) {
  constexpr double kMostNoise = 4e-3;  // of the output, from rounding the input
  moments.setGain(op.output, op.weight);
  const auto mean = [&](auto term) {
    double sum = 0;
    for (uint32_t c = 0; c < op.input.channels; ++c) sum += term(moments.at(op.input, c));
    return sum / op.input.channels;
  };
  const double centre = mean([](Moment m) { return m.mean; });
  const double spread =
      std::sqrt(op.epsilon + mean([&](Moment m) { return m.variance + (m.mean - centre) * (m.mean - centre); }));
  const double rms = std::sqrt(mean([](Moment m) { return m.square(); }));
  if (kHalfRounding * rms > kMostNoise * spread)
    moments.storeInF32(op.input, "its mean drowns what the layer norm behind it looks for");
  for (uint32_t c = 0; c < op.input.channels; ++c) {
    const Moment x = moments.at(op.input, c);
    const double scale = op.weight[c] / spread;
    moments.at(op.output, c) = {(x.mean - centre) * scale + op.bias[c], x.variance * scale * scale};
  }
}

void addExamples(ExampleMaker& maker, std::vector<LayerNorm>& examples) {
  examples.push_back({.input = maker.view({16, 16, 32}),
                      .output = maker.view({16, 16, 32}),
                      .weight = maker.weights(32),
                      .bias = maker.weights(32)});
}

}  // namespace xrds
