// Zhang et al. 2018, "Residual Dense Network for Image Super-Resolution", figure 2.
#include "network/architecture.h"
#include "network/fields.h"
#include "network/super_resolution.h"

namespace xrds {
namespace {

uint32_t growth(const NetworkConfig& config) { return config.symbol("growth"); }

void parse(const Metadata& metadata, NetworkConfig& config) {
  parseSuperResolution(metadata, config);
  parseRange(metadata, config);
  require(config.scale > 1, "is an RDN of scale 1, which has no way up");
  config.blocks = number(metadata, "blocks", 1, 64);
  config.symbols["layers"] = number(metadata, "layers", 1, 64);
  config.symbols["growth"] = number(metadata, "growth", 4, 512);
  require(growth(config) % 4 == 0, "gives a growth that is no multiple of 4");
}

void describe(const NetworkConfig& config, Metadata& metadata) {
  describeSuperResolution(config, metadata);
  describeRange(config, metadata);
  metadata["blocks"] = std::to_string(config.blocks);
  metadata["layers"] = std::to_string(config.symbol("layers"));
  metadata["growth"] = std::to_string(growth(config));
}

// RDB: F_{d,c} = relu(conv3x3([F_{d-1}, F_{d,1}, ... F_{d,c-1}])), of which a 1x1 convolution, plus F_{d-1}: equations
// 4 to 7. Copying F_{d-1} costs little, and the concatenation of the block before is gone by then.
TensorView denseBlock(Layers& layers, const std::string& name, const TensorView& x) {
  const uint32_t c = x.channels, g = growth(layers.config), count = layers.config.symbol("layers");
  const TensorView dense = layers.create(name + "dense", x, c + count * g);
  copyRows(layers.graph, name + "input", x, slice(dense, 0, c));
  return layers.denseConvolutions(
      name, dense, {},
      {.grow = "convs.", .grown = ".conv.0", .fuse = "LFF", .count = count, .growth = g, .inFours = true});
}

// The 1x1 convolution "GFF.0" of [F_1, ... F_D] is a sum of maps "GFF.0.d" of one F each: none of them is kept.
void splitGlobalFusion(Layers& layers) {
  const uint32_t c = layers.config.channels, blocks = layers.config.blocks;
  const auto weight = layers.weight("GFF.0.weight", {c, blocks * c, 1, 1}), bias = layers.weight("GFF.0.bias", {c});
  for (uint32_t d = 0; d < blocks; ++d) {
    std::vector<float> part;
    for (uint32_t n = 0; n < c; ++n) {
      const auto row = weight.subspan((size_t{n} * blocks + d) * c, c);
      part.insert(part.end(), row.begin(), row.end());
    }
    const std::string name = "GFF.0." + std::to_string(d);
    layers.derive(name + ".weight", std::move(part));
    layers.derive(name + ".bias", d == 0 ? std::vector<float>(bias.begin(), bias.end()) : std::vector<float>(c));
  }
}

void forward(Layers& layers, FrameShape frame) {
  const NetworkConfig& config = layers.config;
  const uint32_t c = config.channels;
  const Prepared prepared = prepareFrame(layers, frame);
  const TensorView first = layers.conv("SFENet1", normalizedColour(layers, prepared.x), 3, c, {});
  TensorView f = layers.conv("SFENet2", first, c, c, {.inFours = true}), fused;
  splitGlobalFusion(layers);
  for (uint32_t d = 0; d < config.blocks; ++d) {
    f = denseBlock(layers, "RDBs." + std::to_string(d) + ".", f);
    fused = layers.conv1x1("GFF.0." + std::to_string(d), f, c, {}, fused);
  }
  const TensorView u = layers.conv("GFF.1", fused, c, c, {.residual = first, .inFours = true});
  const std::string output = "UPNet." + std::to_string(2 * config.steps());
  denormalize(layers, output, growth(config), 3);
  upscale(layers, u, prepared, doublingNames(config, "UPNet."), output, growth(config));
}

// Configurations B and A of its section 5; parameters and multiply-adds are counted by hand from that.
constexpr PublishedNetwork kPublished[] = {
    {"rdn", "scale=4 channels=64 transfer=none blocks=16 layers=8 growth=64 range=255", 22.271, 1309.2},
    {"rdn_a", "scale=4 channels=64 transfer=none blocks=20 layers=6 growth=32 range=255", 5.579, 328.1}};
constexpr const char* kSmall = "scale=4 channels=16 transfer=log1p blocks=2 layers=2 growth=8 range=255";

}  // namespace

const Architecture kRdn{"rdn", parse, describe, forward, kPublished, kSmall};

}  // namespace xrds
