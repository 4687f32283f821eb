#include "graph/network.h"

#include "xrds/error.h"

namespace xrds {
namespace {

uint32_t roundUp(uint32_t value, uint32_t multiple) { return ceilDivide(value, multiple) * multiple; }

/// The network as a list of nodes: the functions below read like the paper's section 3, each returning the view that
/// its last node writes. `into` names a slice to write to, so that a concatenation is never copied.
class NetworkBuilder {
 public:
  NetworkBuilder(const NetworkConfig& config, const WeightLookup& weights, Graph& graph, DataType stored)
      : config_(config), weights_(weights), graph_(graph), stored_(stored) {}

  TensorView network(TensorView x, TensorView aux);

 private:
  struct ConvOptions {
    TensorView into{}, residual{};
    Activation activation = Activation::none;
    bool unshuffle = false, shuffle = false;
  };
  TensorView conv(const std::string& name, TensorView x, uint32_t inputs, uint32_t outputs, ConvOptions options);
  TensorView conv(const std::string& name, TensorView x, uint32_t outputs) {
    return conv(name, x, x.channels, outputs, {});
  }
  TensorView linear(const std::string& name, TensorView x, uint32_t outputs, TensorView into = {},
                    TensorView residual = {}, Activation activation = Activation::none);
  TensorView conv1x1(const std::string& name, TensorView x, uint32_t outputs, TensorView into,
                     TensorView residual = {});
  TensorView addLinear(const std::string& name, Linear op);
  TensorView layerNorm(const std::string& name, TensorView x);
  TensorView attention(const std::string& name, TensorView q, TensorView k, TensorView v, bool shifted);
  TensorView selfAttention(const std::string& name, TensorView x, TensorView residual, bool shifted);
  TensorView mlp(const std::string& name, TensorView x, uint32_t ratio, TensorView residual, TensorView into);
  TensorView copy(const std::string& name, TensorView x, TensorView into);

  TensorView deshuffle(uint32_t i, TensorView h, TensorView into);
  TensorView crossModule(const std::string& name, TensorView f, TensorView e, TensorView into);
  TensorView swinLayer(const std::string& name, TensorView t, bool shifted);
  TensorView joined(const std::string& name, TensorView f, TensorView d, TensorView into);
  TensorView denseBlock(const std::string& name, TensorView dense, uint32_t block, TensorView into);
  TensorView swinBlock(const std::string& name, TensorView x, uint32_t block, TensorView into);
  TensorView convBlock(const std::string& name, TensorView dense, TensorView into);
  TensorView block(const std::string& name, TensorView dense, uint32_t block, TensorView into);
  TensorView group(uint32_t g, TensorView f, TensorView d, TensorView into);

  std::span<const float> weight(const std::string& name, std::initializer_list<uint32_t> shape) {
    return weights_(name, std::span(shape.begin(), shape.size()));
  }
  TensorView create(const std::string& name, const TensorView& like, uint32_t channels) {
    return graph_.create(name, stored_, {like.height, like.width, channels});
  }

  const NetworkConfig& config_;
  const WeightLookup& weights_;
  Graph& graph_;
  DataType stored_;
};

TensorView NetworkBuilder::conv(const std::string& name, TensorView x, uint32_t inputs, uint32_t outputs,
                                ConvOptions options) {
  TensorShape shape{x.height, x.width, roundUp(outputs, 4)};
  if (options.unshuffle) shape = {x.height / 2, x.width / 2, shape.channels};
  if (options.shuffle) shape = {2 * shape.height, 2 * shape.width, outputs / 4};
  Conv3x3 op;
  op.input = x;
  op.output = options.into.exists() ? options.into : graph_.create(name, stored_, shape);
  op.residual = options.residual;
  op.weight = weight(name + ".weight", {outputs, inputs, 3, 3});
  op.bias = weight(name + ".bias", {outputs});
  op.inputChannels = inputs;
  op.outputChannels = outputs;
  op.activation = options.activation;
  op.unshuffleInput = options.unshuffle;
  op.shuffleOutput = options.shuffle;
  op.weightType = stored_;
  graph_.nodes.push_back({name, op});
  return op.output;
}

TensorView NetworkBuilder::addLinear(const std::string& name, Linear op) {
  op.bias = weight(name + ".bias", {op.output.channels});
  op.weightType = stored_;
  graph_.nodes.push_back({name, op});
  return op.output;
}

TensorView NetworkBuilder::linear(const std::string& name, TensorView x, uint32_t outputs, TensorView into,
                                  TensorView residual, Activation activation) {
  return addLinear(name, {.input = x,
                          .output = into.exists() ? into : create(name, x, outputs),
                          .residual = residual,
                          .weight = weight(name + ".weight", {outputs, x.channels}),
                          .activation = activation});
}

// In NHWC a 1x1 convolution is a linear map of each pixel; only the weight's shape in the file differs.
TensorView NetworkBuilder::conv1x1(const std::string& name, TensorView x, uint32_t outputs, TensorView into,
                                   TensorView residual) {
  return addLinear(name, {.input = x,
                          .output = into.exists() ? into : create(name, x, outputs),
                          .residual = residual,
                          .weight = weight(name + ".weight", {outputs, x.channels, 1, 1})});
}

TensorView NetworkBuilder::layerNorm(const std::string& name, TensorView x) {
  LayerNorm op;
  op.input = x;
  op.output = create(name, x, x.channels);
  op.weight = weight(name + ".weight", {x.channels});
  op.bias = weight(name + ".bias", {x.channels});
  graph_.nodes.push_back({name, op});
  return op.output;
}

TensorView NetworkBuilder::attention(const std::string& name, TensorView q, TensorView k, TensorView v, bool shifted) {
  const uint32_t side = 2 * config_.window - 1;
  WindowAttention op;
  op.queries = q;
  op.keys = k;
  op.values = v;
  op.output = create(name, q, q.channels);
  op.biasTable = weight(name + ".relative_position_bias_table", {side * side, q.channels / config_.headChannels});
  op.window = config_.window;
  op.headChannels = config_.headChannels;
  op.shift = shifted ? config_.window / 2 : 0;
  graph_.nodes.push_back({name, op});
  return op.output;
}

TensorView NetworkBuilder::selfAttention(const std::string& name, TensorView x, TensorView residual, bool shifted) {
  const uint32_t c = x.channels;
  const TensorView qkv = linear(name + ".qkv", x, 3 * c);
  const TensorView heads = attention(name, slice(qkv, 0, c), slice(qkv, c, c), slice(qkv, 2 * c, c), shifted);
  return linear(name + ".proj", heads, c, {}, residual);
}

TensorView NetworkBuilder::mlp(const std::string& name, TensorView x, uint32_t ratio, TensorView residual,
                               TensorView into) {
  const TensorView hidden = linear(name + ".fc1", x, ratio * x.channels, {}, {}, Activation::gelu);
  return linear(name + ".fc2", hidden, x.channels, into, residual);
}

TensorView NetworkBuilder::copy(const std::string& name, TensorView x, TensorView into) {
  graph_.nodes.push_back({name, BoxMean{.input = x, .output = into, .scale = 1}});  // the mean of one pixel
  return into;
}

// D_i = deshuffle_i(H_i): n steps of pixel-unshuffle and convolution, the last one to C channels.
TensorView NetworkBuilder::deshuffle(uint32_t i, TensorView h, TensorView into) {
  const std::string name = "deshuffle." + std::to_string(i) + ".";
  if (config_.steps() == 0) return conv(name + "0", h, h.channels, config_.channels, {.into = into});
  for (uint32_t j = 0; j < config_.steps(); ++j) {
    const bool last = j + 1 == config_.steps();
    ConvOptions options{.activation = last ? Activation::none : Activation::relu, .unshuffle = true};
    if (last) options.into = into;
    h = conv(name + std::to_string(j), h, 4 * h.channels, last ? config_.channels : config_.auxChannels, options);
  }
  return h;
}

// XM: f1 = f + WMSA(LN(f)); f2 = f1 + WMCA(LN(f1), LN(e)); f2 + MLP_4(LN(f2)).
TensorView NetworkBuilder::crossModule(const std::string& name, TensorView f, TensorView e, TensorView into) {
  const uint32_t c = config_.channels;
  f = selfAttention(name + "self_attn", layerNorm(name + "norm1", f), f, false);
  if (e.exists()) {
    const TensorView q = linear(name + "cross_attn.q", layerNorm(name + "norm2", f), c);
    const TensorView kv = linear(name + "cross_attn.kv", layerNorm(name + "norm_aux", e), 2 * c);
    const TensorView heads = attention(name + "cross_attn", q, slice(kv, 0, c), slice(kv, c, c), false);
    f = linear(name + "cross_attn.proj", heads, c, {}, f);
  }
  return mlp(name + "mlp", layerNorm(name + "norm3", f), 4, f, into);
}

// X: what the features of the colour and the auxiliary images make together, by XM or by a 1x1 convolution of [f, e].
TensorView NetworkBuilder::joined(const std::string& name, TensorView f, TensorView d, TensorView into) {
  const uint32_t c = config_.channels;
  if (config_.cross == CrossKind::attention) {
    const TensorView e = d.exists() ? conv(name + "aux_conv", d, c) : TensorView{};
    return crossModule(name + "xm.", conv(name + "lr_conv", f, c), e, into);
  }
  if (!d.exists()) return conv(name + "lr_conv", f, c, c, {.into = into});
  const TensorView both = create(name + "both", f, 2 * c);
  conv(name + "lr_conv", f, c, c, {.into = slice(both, 0, c)});
  conv(name + "aux_conv", d, c, c, {.into = slice(both, c, c)});
  return conv1x1(name + "concat", both, c, into);
}

// STL: u = t + WMSA(LN(t)); u + MLP_2(LN(u)).
TensorView NetworkBuilder::swinLayer(const std::string& name, TensorView t, bool shifted) {
  const TensorView u = selfAttention(name + "attn", layerNorm(name + "norm1", t), t, shifted);
  return mlp(name + "mlp", layerNorm(name + "norm2", u), 2, u, {});
}

// RDST: three Swin layers over the growing concatenation `dense` = [x, y_1, y_2], of which x is there already.
TensorView NetworkBuilder::denseBlock(const std::string& name, TensorView dense, uint32_t block, TensorView into) {
  const uint32_t c = config_.channels;
  TensorView y;
  for (uint32_t k = 0; k < 3; ++k) {
    const std::string layer = name + "layers." + std::to_string(k) + ".";
    const TensorView u = swinLayer(layer, slice(dense, 0, (k + 1) * c), (3 * block + k) % 2 == 1);
    y = conv1x1(name + "grow." + std::to_string(k), u, c, k < 2 ? slice(dense, (k + 1) * c, c) : TensorView{});
  }
  return conv(name + "conv", y, c, c, {.into = into, .residual = slice(dense, 0, c)});
}

// RSTB: three Swin layers and a convolution, plus x.
TensorView NetworkBuilder::swinBlock(const std::string& name, TensorView x, uint32_t block, TensorView into) {
  TensorView t = x;
  for (uint32_t k = 0; k < 3; ++k)
    t = swinLayer(name + "layers." + std::to_string(k) + ".", t, (3 * block + k) % 2 == 1);
  return conv(name + "conv", t, x.channels, x.channels, {.into = into, .residual = x});
}

// RDB: three convolutions over the growing concatenation `dense` = [x, y_1, y_2, y_3], of which x is there already, and
// a 1x1 convolution of all of it, plus x.
TensorView NetworkBuilder::convBlock(const std::string& name, TensorView dense, TensorView into) {
  const uint32_t c = config_.channels;
  for (uint32_t k = 0; k < 3; ++k)
    conv(name + "grow." + std::to_string(k), slice(dense, 0, (k + 1) * c), (k + 1) * c, c,
         {.into = slice(dense, (k + 1) * c, c), .activation = Activation::relu});
  return conv1x1(name + "fuse", dense, c, into, slice(dense, 0, c));
}

TensorView NetworkBuilder::block(const std::string& name, TensorView dense, uint32_t block, TensorView into) {
  if (config_.block == BlockKind::rstb) return swinBlock(name, dense, block, into);
  if (config_.block == BlockKind::rdb) return convBlock(name, dense, into);
  return denseBlock(name, dense, block, into);
}

// XDG: F_g = conv3x3(G_B) + X. A block's input is the start of its concatenation `dense`, or all of it.
TensorView NetworkBuilder::group(uint32_t g, TensorView f, TensorView d, TensorView into) {
  const uint32_t c = config_.channels;
  const uint32_t parts = config_.block == BlockKind::rdst ? 3 : config_.block == BlockKind::rdb ? 4 : 1;
  const std::string name = "groups." + std::to_string(g) + ".";
  const auto blockName = [&](uint32_t b) { return name + "blocks." + std::to_string(b) + "."; };
  TensorView dense = create(blockName(0) + "dense", f, parts * c);
  // X outlives the first of several blocks: holding that block's concatenation so long would cost more than a copy.
  const bool copied = parts > 1 && config_.blocks > 1;
  const TensorView x = joined(name, f, d, copied ? TensorView{} : slice(dense, 0, c));
  if (copied) copy(blockName(0) + "input", x, slice(dense, 0, c));
  TensorView y;
  for (uint32_t b = 0; b < config_.blocks; ++b) {
    const bool last = b + 1 == config_.blocks;
    const TensorView next = last ? TensorView{} : create(blockName(b + 1) + "dense", f, parts * c);
    y = block(blockName(b), dense, b, last ? TensorView{} : slice(next, 0, c));
    dense = next;
  }
  return conv(name + "conv", y, c, c, {.into = into, .residual = x});
}

TensorView NetworkBuilder::network(TensorView x, TensorView aux) {
  const uint32_t c = config_.channels, ca = config_.auxChannels;
  const TensorView fused = create("fused", x, aux.exists() ? 2 * c : c);

  // Auxiliary branch: H_i = H_{i-1} + conv3x3(relu(conv3x3(H_{i-1}))), D_i = deshuffle_i(H_i).
  std::vector<TensorView> d(config_.groups + 1);
  TensorView h = aux.exists() ? conv("aux_conv", aux, config_.auxWidth(), ca, {}) : TensorView{};
  for (uint32_t i = 0; aux.exists() && i <= config_.groups; ++i) {
    if (i > 0) {
      const std::string name = "aux_blocks." + std::to_string(i - 1) + ".";
      const TensorView inner = conv(name + "conv1", h, ca, ca, {.activation = Activation::relu});
      h = conv(name + "conv2", inner, ca, ca, {.residual = h});
    }
    d[i] = deshuffle(i, h, i == config_.groups ? slice(fused, c, c) : TensorView{});
  }

  // Low-resolution branch.
  const TensorView f0 = conv("lr_conv", x, 3, c, {});
  TensorView f = f0;
  for (uint32_t g = 0; g < config_.groups; ++g)
    f = group(g, f, d[g], g + 1 == config_.groups ? slice(fused, 0, c) : TensorView{});

  // Fusion and upscaling.
  TensorView u = conv("fuse", fused, c);
  u = conv("body_conv", u, c, c, {.residual = f0});
  const uint32_t steps = config_.steps();
  const TensorView upscaled = graph_.create(
      "upscaled", stored_, {config_.scale * x.height, config_.scale * x.width, c + (config_.auxSkip ? ca : 0)});
  const TensorView target = slice(upscaled, 0, c);
  u = conv("up_pre", u, c, c, {.into = steps == 0 ? target : TensorView{}, .activation = Activation::leakyRelu});
  for (uint32_t j = 0; j < steps; ++j)
    u = conv("up." + std::to_string(j), u, c, 4 * c, {.into = j + 1 == steps ? target : TensorView{}, .shuffle = true});
  if (config_.auxSkip)
    copy("aux_skip", h, slice(upscaled, c, ca));  // holding its place since H_N would cost more memory
  return conv("out", upscaled, upscaled.channels, config_.outputWidth(), {});
}

// Auxiliary channels, their means (of a model that demodulates), and the colour demodulated by these and transformed.
struct Prepared {
  TensorView aux, auxMean, x;
};

// Adds the means and the colour of `height` x `width` pixels to the auxiliary channels.
void encode(const NetworkConfig& config, uint32_t height, uint32_t width, const std::string& prefix, Graph& graph,
            Prepared& prepared) {
  EncodeRadiance op;
  if (config.demodulates()) {
    prepared.auxMean = graph.create(prefix + "auxiliary_mean", DataType::f32, {height, width, prepared.aux.channels});
    graph.nodes.push_back({prefix + "box_mean", BoxMean{prepared.aux, prepared.auxMean, config.scale}});
    op.auxMean = prepared.auxMean;
    op.albedoOffset = config.auxOffset("albedo");
  }
  prepared.x = graph.create(prefix + "x", DataType::f32, {height, width, 4});
  op.colour = graph.colour;
  op.exposure = graph.exposure;
  op.output = prepared.x;
  op.transfer = config.transfer;
  graph.nodes.push_back({prefix + "encode_radiance", op});
}

// As the network sees them: padded.
Prepared prepareInputs(const NetworkConfig& config, FrameShape frame, const GraphOptions& options, Graph& graph) {
  const uint32_t s = config.scale, auxChannels = roundUp(config.auxWidth(), 4);
  const uint32_t height = roundUp(frame.height, config.window), width = roundUp(frame.width, config.window);
  const DataType stored = options.precision == Precision::fp16 ? DataType::f16 : DataType::f32;
  graph.colour = graph.create("colour", DataType::f32, {frame.height, frame.width, 4});
  graph.exposure = graph.create("exposure", DataType::f32, {1, 1, 4});
  if (options.autoExposure) graph.nodes.push_back({"exposure", Exposure{graph.colour, graph.exposure}});
  Prepared prepared;
  if (auxChannels > 0) {
    graph.auxiliary = graph.create("auxiliary", DataType::f32, {s * frame.height, s * frame.width, auxChannels});
    prepared.aux = graph.create("packed_auxiliary", stored, {s * height, s * width, auxChannels});
    PackAuxiliary pack;
    pack.input = graph.auxiliary;
    pack.output = prepared.aux;
    pack.albedoOffset = config.auxOffset("albedo");
    graph.nodes.push_back({"pack_auxiliary", pack});
  }
  encode(config, height, width, "", graph, prepared);
  return prepared;
}

// As the base image and the output are made of them with learned kernels: filtered, of the size of the real image.
Prepared filterInputs(const NetworkConfig& config, const Prepared& prepared, Graph& graph) {
  const TensorShape shape{graph.output.height, graph.output.width, prepared.aux.channels};
  Prepared filtered{.aux = graph.create("filtered.auxiliary", prepared.aux.type, shape)};
  const FilterAuxiliary op{prepared.aux, graph.network, filtered.aux, config.auxKernels, config.firstAuxLogit()};
  graph.nodes.push_back({"filter_auxiliary", op});
  encode(config, graph.colour.height, graph.colour.width, "filtered.", graph, filtered);
  return filtered;
}

TensorView baseImage(const NetworkConfig& config, const Prepared& prepared, Graph& graph) {
  if (config.base == BaseImage::none) return {};
  const TensorView base = graph.create("base", DataType::f32, graph.output.shape());
  if (config.base != BaseImage::guided) {
    graph.nodes.push_back({"bicubic", Bicubic{.input = prepared.x, .output = base, .scale = config.scale}});
    return base;
  }
  JointBilateral op;
  op.input = prepared.x;
  op.aux = prepared.aux;
  op.auxMean = prepared.auxMean;
  if (config.kernels > 0) op.network = graph.network;
  op.output = base;
  op.albedoOffset = config.auxOffset("albedo");
  op.normalOffset = config.auxOffset("normal");
  op.scale = config.scale;
  graph.nodes.push_back({"joint_bilateral", op});
  return base;
}

}  // namespace

Graph buildGraph(const NetworkConfig& config, FrameShape frame, const WeightLookup& weights,
                 const GraphOptions& options) {
  constexpr uint32_t kMaxSide = 65536;
  if (frame.height == 0 || frame.width == 0 || frame.height > kMaxSide / config.scale ||
      frame.width > kMaxSide / config.scale)
    throw Error("A frame of " + std::to_string(frame.width) + " x " + std::to_string(frame.height) +
                " pixels cannot be upscaled by " + std::to_string(config.scale) +
                ": each side of the output must be 1 to 65536 pixels.");
  Graph graph;
  Prepared prepared = prepareInputs(config, frame, options, graph);
  const DataType stored = options.precision == Precision::fp16 ? DataType::f16 : DataType::f32;
  if (config.groups > 0)
    graph.network = NetworkBuilder(config, weights, graph, stored).network(prepared.x, prepared.aux);
  graph.output = graph.create("output", DataType::f32, {config.scale * frame.height, config.scale * frame.width, 4});
  if (config.auxKernels > 0) prepared = filterInputs(config, prepared, graph);
  const TensorView base = baseImage(config, prepared, graph);

  DecodeRadiance decode;
  decode.network = graph.network;
  decode.base = base;
  decode.exposure = graph.exposure;
  decode.output = graph.output;
  decode.transfer = config.transfer;
  if (config.demodulates()) {
    decode.aux = prepared.aux;
    decode.albedoOffset = config.auxOffset("albedo");
  }
  graph.nodes.push_back({"decode_radiance", decode});
  return graph;
}

}  // namespace xrds
