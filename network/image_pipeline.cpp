#include "network/image_pipeline.h"

#include "xrds/auxiliary_input.h"

namespace xrds {
namespace {

TensorView blendedRows(const NetworkConfig& config, Graph& graph, const TensorView& base, const TensorView& noisyAux,
                       const TensorView& network, RowRange rows) {
  BlendColour op;
  op.base = base;
  op.images = graph.auxiliary;
  op.aux = noisyAux;
  op.network = network;
  op.exposure = graph.exposure;
  op.output = graph.createRows("blended", DataType::f32, graph.output.shape(), rows);
  op.colourOffset = config.auxOffset(kFullColour.name);
  op.albedoOffset = config.auxOffset(kAlbedo.name);
  op.kernelSide = config.colourKernels;
  op.firstLogit = config.firstColourLogit();
  op.transfer = config.transfer;
  op.rows = rows;
  graph.nodes.push_back({"blend_colour", op});
  return op.output;
}

// PackAuxiliary::lightChannels.
uint32_t lightChannels(const NetworkConfig& config) {
  uint32_t channels = 0;
  for (const size_t input : config.radianceInputs())
    if (config.auxInputs[input] != kFullColour.name) channels |= 7u << (3 * input);
  return channels;
}

// The linear filter of the base image, applied to one image: learned or joint bilateral kernels, or bicubic weights.
void filterRows(const NetworkConfig& config, Graph& graph, const Prepared& prepared, const TensorView& network,
                const TensorView& input, const TensorView& output, const std::string& name, RowRange rows) {
  if (config.base != BaseImage::guided) {
    graph.nodes.push_back({name, Bicubic{.input = input, .output = output, .scale = config.scale, .rows = rows}});
    return;
  }
  JointBilateral op;
  op.input = input;
  op.aux = prepared.aux;
  op.auxMean = prepared.auxMean;
  if (config.kernels > 0) op.network = network;
  op.output = output;
  op.albedoOffset = config.auxOffset(kAlbedo.name);
  op.normalOffset = config.auxOffset(kNormal.name);
  op.scale = config.scale;
  op.rows = rows;
  graph.nodes.push_back({name, op});
}

TensorView baseRows(const NetworkConfig& config, Graph& graph, const Prepared& prepared, const TensorView& network,
                    RowRange rows) {
  if (config.base == BaseImage::none) return {};
  const TensorView base = graph.createRows("base", DataType::f32, graph.output.shape(), rows);
  filterRows(config, graph, prepared, network, prepared.x, base,
             config.base == BaseImage::guided ? "joint_bilateral" : "bicubic", rows);
  return base;
}

// The most that the network may make of its surroundings, so that it draws nothing where they are black.
TensorView ceilingRows(const NetworkConfig& config, Graph& graph, const TensorView& x, RowRange rows) {
  const TensorShape shape{graph.output.height / config.scale, graph.output.width / config.scale, 4};
  const RowRange low{rows.begin / config.scale, ceilDivide(rows.end, config.scale)};
  const TensorView ceiling = graph.createRows("ceiling", DataType::f32, shape, low);
  graph.nodes.push_back({"radiance_ceiling", RadianceCeiling{x, ceiling, config.transfer, low}});
  return ceiling;
}

}  // namespace

Prepared prepareInputs(const NetworkConfig& config, FrameShape frame, const GraphOptions& options, Graph& graph) {
  const uint32_t s = config.scale, auxChannels = alignUp(config.auxWidth(), 4);
  const uint32_t height = config.padding == Padding::columns ? frame.height : alignUp(frame.height, config.window);
  const uint32_t width = alignUp(frame.width, config.window);
  const DataType stored = options.precision == Precision::fp16 ? DataType::f16 : DataType::f32;
  graph.colour = graph.create("colour", DataType::f32, {frame.height, frame.width, 4});
  for (uint32_t i = 0; i < options.layers; ++i) {
    graph.layers.push_back(graph.create("layer." + std::to_string(i), DataType::f32, graph.colour.shape()));
    graph.layerMeans.push_back(
        graph.create("layer_mean." + std::to_string(i), DataType::f32, {s * frame.height, s * frame.width, 4}));
  }
  graph.exposure = graph.create("exposure", DataType::f32, {1, 1, 4});
  if (options.autoExposure) graph.nodes.push_back({"exposure", Exposure{graph.colour, graph.exposure}});
  Prepared prepared;
  if (auxChannels > 0) {
    graph.auxiliary = graph.create("auxiliary", DataType::f32, {s * frame.height, s * frame.width, auxChannels});
    prepared.aux = graph.create("packed_auxiliary", stored, {s * height, s * width, auxChannels});
    PackAuxiliary pack;
    pack.input = graph.auxiliary;
    pack.output = prepared.aux;
    pack.albedoOffset = config.auxOffset(kAlbedo.name);
    pack.colourOffset = config.auxOffset(kFullColour.name);
    pack.lightChannels = lightChannels(config);
    if (pack.takesRadiance()) {
      pack.exposure = graph.exposure;
      pack.demodulates = config.demodulates();
      pack.transfer = config.transfer;
    }
    graph.nodes.push_back({"pack_auxiliary", pack});
  }
  createEncoded(config, "", height, width, graph, prepared);
  encodeRows(config, "", graph, prepared);
  return prepared;
}

void createEncoded(const NetworkConfig& config, const std::string& prefix, uint32_t height, uint32_t width,
                   Graph& graph, Prepared& prepared) {
  if (config.demodulates())
    prepared.auxMean = graph.create(prefix + "auxiliary_mean", DataType::f32, {height, width, prepared.aux.channels});
  if (!prepared.x.exists()) prepared.x = graph.create(prefix + "x", DataType::f32, {height, width, 4});
}

void meanRows(const NetworkConfig& config, const std::string& prefix, Graph& graph, const Prepared& prepared,
              RowRange rows) {
  if (config.demodulates())
    graph.nodes.push_back({prefix + "box_mean", BoxMean{prepared.aux, prepared.auxMean, config.scale, rows}});
}

void encodeRows(const NetworkConfig& config, const std::string& prefix, Graph& graph, const Prepared& prepared,
                RowRange rows) {
  meanRows(config, prefix, graph, prepared, rows);
  EncodeRadiance op;
  if (config.demodulates()) {
    op.auxMean = prepared.auxMean;
    op.albedoOffset = config.auxOffset(kAlbedo.name);
  }
  op.colour = graph.colour;
  op.exposure = graph.exposure;
  op.output = prepared.x;
  op.reflects = config.padding == Padding::reflection;
  op.transfer = config.transfer;
  op.rows = rows;
  graph.nodes.push_back({prefix + "encode_radiance", op});
}

TensorView prefilteredColour(const NetworkConfig& config, Graph& graph, const Prepared& prepared,
                             const TensorView& logits) {
  const TensorShape shape = graph.colour.shape();
  const uint32_t width = 4 + prepared.auxMean.channels;  // of a level
  Prefilter op;
  if (config.prefilter > 1) {
    op.coarser = graph.create("coarser", DataType::f32, {shape.height, shape.width, (config.prefilter - 1) * width});
    graph.nodes.push_back({"coarser.colour", DilatedMean{graph.colour, slice(op.coarser, 0, 4)}});
    graph.nodes.push_back({"coarser.auxiliary", DilatedMean{prepared.auxMean, slice(op.coarser, 4, width - 4)}});
  }
  for (uint32_t level = 2, step = shader::kPrefilterStep; level < config.prefilter;
       ++level, step *= shader::kPrefilterStep)
    graph.nodes.push_back(
        {"coarser." + std::to_string(level), DilatedMean{slice(op.coarser, (level - 2) * width, width),
                                                         slice(op.coarser, (level - 1) * width, width), step}});
  op.colour = graph.colour;
  op.auxMean = prepared.auxMean;
  op.logits = logits;
  op.exposure = graph.exposure;
  op.output = graph.create("prefiltered", DataType::f32, shape);
  op.levels = config.prefilter;
  op.albedoOffset = config.auxOffset(kAlbedo.name);
  op.normalOffset = config.auxOffset(kNormal.name);
  op.transfer = config.transfer;
  graph.nodes.push_back({"prefilter_colour", op});
  return op.output;
}

void decodeRows(const NetworkConfig& config, Graph& graph, const Decoded& decoded, const TensorView& network,
                RowRange rows) {
  DecodeRadiance decode;
  decode.network = network;
  decode.base = baseRows(config, graph, decoded.base, network, rows);
  if (config.colourKernels > 0) decode.base = blendedRows(config, graph, decode.base, decoded.noisyAux, network, rows);
  if (decode.base.exists() && network.exists()) decode.ceiling = ceilingRows(config, graph, decoded.x, rows);
  decode.scale = config.scale;
  decode.exposure = graph.exposure;
  decode.output = graph.output;
  decode.transfer = config.transfer;
  decode.rows = rows;
  if (config.demodulates()) {
    decode.aux = decoded.base.aux;
    decode.albedoOffset = config.auxOffset(kAlbedo.name);
  }
  if (config.behindDenoiser && config.restraint.isAny()) {
    decode.colour = graph.colour;
    decode.darker = static_cast<float>(config.restraint.darker) / 100;
    decode.brighter = static_cast<float>(config.restraint.brighter) / 100;
  }
  graph.nodes.push_back({"decode_radiance", decode});
  for (size_t i = 0; i < graph.layers.size(); ++i)
    filterRows(config, graph, decoded.base, network, graph.layers[i], graph.layerMeans[i], "layers", rows);
}

}  // namespace xrds
