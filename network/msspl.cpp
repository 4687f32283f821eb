// Hou et al. 2021, "Fast Monte Carlo Rendering via Multi-Resolution Sampling", figure of the network. The layers inside
// its modules are our reading (docs/networks.md).
#include "network/architecture.h"
#include "network/fields.h"
#include "network/super_resolution.h"

namespace xrds {
namespace {

void parse(const Metadata& metadata, NetworkConfig& config) {
  parseSuperResolution(metadata, config);
  config.groups = number(metadata, "groups", 1, 64);
  config.blocks = number(metadata, "blocks", 1, 64);
  config.auxInputs = splitList(field(metadata, "aux_inputs"));
  checkAuxiliaryInputs(config);
  require(config.scale > 1 || config.auxInputs.empty(), "has auxiliary inputs at scale 1, where none is downscaled");
}

void describe(const NetworkConfig& config, Metadata& metadata) {
  describeSuperResolution(config, metadata);
  metadata["groups"] = std::to_string(config.groups);
  metadata["blocks"] = std::to_string(config.blocks);
  metadata["aux_inputs"] = joinedList(config.auxInputs);
}

// F_HRLS: n times a pixel unshuffle by 2, a convolution and a ReLU, the last into `into`.
void downscale(Layers& layers, TensorView x, const TensorView& into) {
  const NetworkConfig& config = layers.config;
  for (uint32_t j = 0; j < config.steps(); ++j)
    x = layers.conv("down." + std::to_string(j), x, 4 * (j == 0 ? config.auxWidth() : config.channels), config.channels,
                    {.into = j + 1 == config.steps() ? into : TensorView{},
                     .activation = Activation::relu,
                     .unshuffle = true,
                     .inFours = true});
}

// u + v, two values.
TensorView sum(Layers& layers, const std::string& name, const TensorView& u, const TensorView& v) {
  const TensorView into = layers.create(name, u, u.channels);
  layers.graph.nodes.push_back({name, GatedSum{.input = u, .output = into, .addend = v}});
  return into;
}

// RDG: residual dense blocks, plus x. A block's input is the start of its concatenation `dense`.
TensorView group(Layers& layers, const std::string& name, const TensorView& x) {
  const uint32_t c = x.channels, blocks = layers.config.blocks;
  const auto denseOf = [&](uint32_t b) { return layers.create(name + std::to_string(b) + ".dense", x, 4 * c); };
  const TensorView f = layers.create(name + "blocks", x, c);
  TensorView dense = denseOf(0);
  copyRows(layers.graph, name + "input", x, slice(dense, 0, c));
  for (uint32_t b = 0; b < blocks; ++b) {
    const TensorView next = b + 1 < blocks ? denseOf(b + 1) : TensorView{};
    layers.denseConvolutions(name + std::to_string(b) + ".", dense, next.exists() ? slice(next, 0, c) : f,
                             {.inFours = true});
    dense = next;
  }
  return sum(layers, name + "skip", f, x);
}

void forward(Layers& layers, FrameShape frame) {
  const NetworkConfig& config = layers.config;
  const uint32_t c = config.channels;
  const Prepared prepared = prepareFrame(layers, frame);
  const TensorView both = layers.create("both", prepared.x, config.auxInputs.empty() ? c : 2 * c);
  const TensorView low = layers.conv("conv", prepared.x, 3, c, {.into = slice(both, 0, c)});
  TensorView f = low;
  if (!config.auxInputs.empty()) {
    downscale(layers, prepared.aux, slice(both, c, c));
    f = layers.conv1x1("fusion", both, c, {});
  }
  for (uint32_t g = 0; g < config.groups; ++g) f = group(layers, "groups." + std::to_string(g) + ".", f);
  f = sum(layers, "long_skip", f, low);
  std::vector<std::string> doublings;
  for (uint32_t j = 0; j < config.steps(); ++j) doublings.push_back("up." + std::to_string(j));
  upscale(layers, f, prepared, doublings, "out");
}

constexpr PublishedNetwork kPublished[] = {
    {"msspl", "scale=4 channels=64 transfer=none groups=3 blocks=5 aux_inputs=albedo,normal"}};
constexpr const char* kSmall = "scale=4 channels=16 transfer=log1p groups=1 blocks=2 aux_inputs=colour,albedo,normal";

}  // namespace

const Architecture kMsspl{"msspl", parse, describe, forward, kPublished, kSmall};

}  // namespace xrds
