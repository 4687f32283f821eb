// Zhang et al. 2018, "Image Super-Resolution Using Very Deep Residual Channel Attention Networks", figure 2.
#include "network/architecture.h"
#include "network/fields.h"
#include "network/super_resolution.h"

namespace xrds {
namespace {

void parse(const Metadata& metadata, NetworkConfig& config) {
  parseSuperResolution(metadata, config);
  parseRange(metadata, config);
  config.groups = number(metadata, "groups", 1, 64);
  config.blocks = number(metadata, "blocks", 1, 64);
  config.symbols["reduction"] = number(metadata, "reduction", 1, config.channels);
  require(config.channels % config.symbol("reduction") == 0, "gives channels that are no multiple of reduction");
}

void describe(const NetworkConfig& config, Metadata& metadata) {
  describeSuperResolution(config, metadata);
  describeRange(config, metadata);
  metadata["groups"] = std::to_string(config.groups);
  metadata["blocks"] = std::to_string(config.blocks);
  metadata["reduction"] = std::to_string(config.symbol("reduction"));
}

// x + t sigmoid(W_U relu(W_D mean(t))), equations 7 to 9. The mean is of the frame with its padded columns.
TensorView channelAttention(Layers& layers, const std::string& name, TensorView t, TensorView x) {
  const uint32_t c = t.channels, few = c / layers.config.symbol("reduction");
  Graph& graph = layers.graph;
  const TensorView means = graph.create(name + "mean", DataType::f32, {t.height, 1, c});
  const TensorView gate = graph.create(name + "gate", DataType::f32, {1, 1, c});
  const TensorView sum = layers.create(name + "sum", t, c);
  graph.nodes.push_back({name + "mean", RowMean{t, means}});
  ChannelGate op{.input = means, .output = gate};
  op.weight = layers.weight(name + "conv_du.0.weight", {few, c, 1, 1});
  op.bias = layers.weight(name + "conv_du.0.bias", {few});
  op.upWeight = layers.weight(name + "conv_du.2.weight", {c, few, 1, 1});
  op.upBias = layers.weight(name + "conv_du.2.bias", {c});
  graph.nodes.push_back({name + "gate", op});
  graph.nodes.push_back({name + "sum", GatedSum{t, sum, gate, x}});
  return sum;
}

// RCAB.
TensorView attentionBlock(Layers& layers, const std::string& name, TensorView x) {
  const uint32_t c = x.channels;
  TensorView t = layers.conv(name + "0", x, c, c, {.activation = Activation::relu, .inFours = true});
  t = layers.conv(name + "2", t, c, c, {.inFours = true});
  return channelAttention(layers, name + "3.", t, x);
}

TensorView residualGroup(Layers& layers, const std::string& name, TensorView x) {
  const uint32_t c = x.channels, blocks = layers.config.blocks;
  TensorView f = x;
  for (uint32_t b = 0; b < blocks; ++b) f = attentionBlock(layers, name + std::to_string(b) + ".body.", f);
  return layers.conv(name + std::to_string(blocks), f, c, c, {.residual = x, .inFours = true});
}

void forward(Layers& layers, FrameShape frame) {
  const NetworkConfig& config = layers.config;
  const uint32_t c = config.channels;
  const Prepared prepared = prepareFrame(layers, frame);
  const TensorView head = layers.conv("head.0", normalizedColour(layers, prepared.x), 3, c, {});
  TensorView f = head;
  for (uint32_t g = 0; g < config.groups; ++g) f = residualGroup(layers, "body." + std::to_string(g) + ".body.", f);
  upscaleFromTrunk(layers, "body." + std::to_string(config.groups), f, head, prepared);
}

constexpr PublishedNetwork kPublished[] = {
    {"rcan", "scale=4 channels=64 transfer=none groups=10 blocks=20 reduction=16 range=255", 15.59, 917}};
constexpr const char* kSmall = "scale=4 channels=16 transfer=log1p groups=1 blocks=2 reduction=4";

}  // namespace

const Architecture kRcan{"rcan", parse, describe, forward, kPublished, kSmall};

}  // namespace xrds
