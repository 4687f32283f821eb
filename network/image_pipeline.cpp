#include "network/image_pipeline.h"

#include "xrds/auxiliary_input.h"

namespace xrds {
namespace {

TensorView baseRows(const NetworkConfig& config, Graph& graph, const Prepared& prepared, const TensorView& network,
                    RowRange rows) {
  if (config.base == BaseImage::none) return {};
  const TensorView base = graph.createRows("base", DataType::f32, graph.output.shape(), rows);
  if (config.base != BaseImage::guided) {
    graph.nodes.push_back(
        {"bicubic", Bicubic{.input = prepared.x, .output = base, .scale = config.scale, .rows = rows}});
    return base;
  }
  JointBilateral op;
  op.input = prepared.x;
  op.aux = prepared.aux;
  op.auxMean = prepared.auxMean;
  if (config.kernels > 0) op.network = network;
  op.output = base;
  op.albedoOffset = config.auxOffset(kAlbedo.name);
  op.normalOffset = config.auxOffset(kNormal.name);
  op.scale = config.scale;
  op.rows = rows;
  graph.nodes.push_back({"joint_bilateral", op});
  return base;
}

// The most that the network may make of its surroundings, so that it draws nothing where they are black.
TensorView ceilingRows(const NetworkConfig& config, Graph& graph, const Prepared& prepared, RowRange rows) {
  const TensorShape shape{graph.output.height / config.scale, graph.output.width / config.scale, 4};
  const RowRange low{rows.begin / config.scale, ceilDivide(rows.end, config.scale)};
  const TensorView ceiling = graph.createRows("ceiling", DataType::f32, shape, low);
  graph.nodes.push_back({"radiance_ceiling", RadianceCeiling{prepared.x, ceiling, config.transfer, low}});
  return ceiling;
}

}  // namespace

Prepared prepareInputs(const NetworkConfig& config, FrameShape frame, const GraphOptions& options, Graph& graph) {
  const uint32_t s = config.scale, auxChannels = alignUp(config.auxWidth(), 4);
  const uint32_t height = alignUp(frame.height, config.window), width = alignUp(frame.width, config.window);
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
    pack.albedoOffset = config.auxOffset(kAlbedo.name);
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
  prepared.x = graph.create(prefix + "x", DataType::f32, {height, width, 4});
}

void encodeRows(const NetworkConfig& config, const std::string& prefix, Graph& graph, const Prepared& prepared,
                RowRange rows) {
  EncodeRadiance op;
  if (config.demodulates()) {
    graph.nodes.push_back({prefix + "box_mean", BoxMean{prepared.aux, prepared.auxMean, config.scale, rows}});
    op.auxMean = prepared.auxMean;
    op.albedoOffset = config.auxOffset(kAlbedo.name);
  }
  op.colour = graph.colour;
  op.exposure = graph.exposure;
  op.output = prepared.x;
  op.transfer = config.transfer;
  op.rows = rows;
  graph.nodes.push_back({prefix + "encode_radiance", op});
}

void decodeRows(const NetworkConfig& config, Graph& graph, const Prepared& prepared, const TensorView& network,
                RowRange rows) {
  DecodeRadiance decode;
  decode.network = network;
  decode.base = baseRows(config, graph, prepared, network, rows);
  if (decode.base.exists() && network.exists()) decode.ceiling = ceilingRows(config, graph, prepared, rows);
  decode.scale = config.scale;
  decode.exposure = graph.exposure;
  decode.output = graph.output;
  decode.transfer = config.transfer;
  decode.rows = rows;
  if (config.demodulates()) {
    decode.aux = prepared.aux;
    decode.albedoOffset = config.auxOffset(kAlbedo.name);
  }
  graph.nodes.push_back({"decode_radiance", decode});
}

}  // namespace xrds
