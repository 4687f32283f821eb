// Hou & Liu 2023, "Auxiliary Features-Guided Super Resolution for Monte Carlo Rendering", section 3.
#include <bit>

#include "network/architecture.h"
#include "network/auxiliary_branch.h"
#include "network/fields.h"
#include "network/low_resolution_branch.h"
#include "network/upsampling.h"
#include "xrds/auxiliary_input.h"

namespace xrds {
namespace {

constexpr const char* kTransfers[] = {"none", "log1p"};
constexpr const char* kBases[] = {"none", "bicubic", "demodulated", "guided"};
constexpr const char* kBlocks[] = {"rdst", "rstb", "rdb"};  // the first is the paper's, which a file need not state
constexpr const char* kCrosses[] = {"attention", "concat"};

void checkCombination(const NetworkConfig& config) {
  require(std::has_single_bit(config.scale),
          "gives scale " + std::to_string(config.scale) + ", expected 1, 2, 4, 8 or 16");
  require(config.channels % 4 == 0 && config.auxChannels % 4 == 0 && config.headChannels % 4 == 0,
          "gives channels that are no multiples of 4");
  require(config.channels % config.headChannels == 0, "gives channels that are no multiple of head_channels");
  require(config.window % 2 == 0, "gives an odd window");
  checkAuxiliaryInputs(config);
  require(!config.demodulates() || config.auxOffset(kAlbedo.name) >= 0, "has a base image that needs an albedo input");
  require(config.kernels == 0 || (config.kernels == 5 && config.base == BaseImage::guided),
          "has learned kernels, which need side 5 and the guided base");
  require(config.auxKernels == 0 || config.auxKernels == 3 || config.auxKernels == 5,
          "gives aux_kernels " + std::to_string(config.auxKernels) + ", expected 0, 3 or 5");
  require(config.outputSide == 1 || config.outputSide == 3,
          "gives output_side " + std::to_string(config.outputSide) + ", expected 1 or 3");
  require(config.auxKernels == 0 || config.demodulates(),
          "has learned kernels for its auxiliary images, which need a base image that demodulates");
  require(config.colourKernels == 0 || config.colourKernels == 3 || config.colourKernels == 5,
          "gives colour_kernels " + std::to_string(config.colourKernels) + ", expected 0, 3 or 5");
  const bool full = config.auxOffset(kFullColour.name) >= 0;
  require(config.colourKernels == 0 || (full && config.base == BaseImage::guided),
          "has learned kernels for the full-resolution colour, which need the input colour and the guided base");
  require(!full || config.scale > 1, "takes the full-resolution colour at scale 1, where there is no other");
  require(config.prefilter == 0 || config.base == BaseImage::guided, "has a prefilter, which needs the guided base");
  require(config.groups > 0 || config.prefilter == 0, "has a prefilter but no network");
  require(config.groups > 0 || (config.base != BaseImage::none && config.outputWidth() == 3),
          "has neither a network nor a base image");
  require(config.scale == 1 || !config.restraint.isAny(),
          "restrains what it changes in a denoised colour, which needs scale 1");
  require(!config.auxSkip || !config.auxInputs.empty(), "has an auxiliary skip but no auxiliary input");
}

void parse(const Metadata& metadata, NetworkConfig& config) {
  config.scale = number(metadata, "scale", 1, 16);
  config.channels = number(metadata, "channels", 4, 512);
  config.auxInputs = splitList(field(metadata, "aux_inputs"));
  config.auxChannels = number(metadata, "aux_channels", config.auxInputs.empty() ? 0 : 4, 512);
  config.groups = number(metadata, "groups", 0, 64);
  config.blocks = number(metadata, "blocks", 1, 64);
  config.window = number(metadata, "window", 2, 16);
  config.headChannels = number(metadata, "head_channels", 4, 512);
  config.transfer = static_cast<Transfer>(choice(metadata, "transfer", kTransfers));
  config.base = static_cast<BaseImage>(choice(metadata, "base", kBases));
  config.block = static_cast<BlockKind>(choiceOrFirst(metadata, "block", kBlocks));
  config.cross = static_cast<CrossKind>(choiceOrFirst(metadata, "cross", kCrosses));
  config.kernels = numberOr(metadata, "kernels", 0, 5);
  config.auxSkip = numberOr(metadata, "aux_skip", 0, 1) == 1;
  config.auxKernels = numberOr(metadata, "aux_kernels", 0, 5);
  config.colourKernels = numberOr(metadata, "colour_kernels", 0, 5);
  config.prefilter = numberOr(metadata, "prefilter", 0, 3);
  config.outputSide = numberOr(metadata, "output_side", 3, 3);
  config.restraint = {numberOr(metadata, "denoised_darker", 100, 100),
                      numberOr(metadata, "denoised_brighter", 100, 100)};
  checkCombination(config);
}

void describe(const NetworkConfig& config, Metadata& metadata) {
  metadata["scale"] = std::to_string(config.scale);
  metadata["channels"] = std::to_string(config.channels);
  metadata["aux_channels"] = std::to_string(config.auxChannels);
  metadata["aux_inputs"] = joinedList(config.auxInputs);
  metadata["groups"] = std::to_string(config.groups);
  metadata["blocks"] = std::to_string(config.blocks);
  metadata["window"] = std::to_string(config.window);
  metadata["head_channels"] = std::to_string(config.headChannels);
  metadata["transfer"] = kTransfers[static_cast<size_t>(config.transfer)];
  metadata["base"] = kBases[static_cast<size_t>(config.base)];
  metadata["block"] = kBlocks[static_cast<size_t>(config.block)];
  metadata["cross"] = kCrosses[static_cast<size_t>(config.cross)];
  metadata["kernels"] = std::to_string(config.kernels);
  metadata["aux_skip"] = config.auxSkip ? "1" : "0";
  metadata["aux_kernels"] = std::to_string(config.auxKernels);
  metadata["colour_kernels"] = std::to_string(config.colourKernels);
  metadata["prefilter"] = std::to_string(config.prefilter);
  metadata["output_side"] = std::to_string(config.outputSide);
  metadata["denoised_darker"] = std::to_string(config.restraint.darker);
  metadata["denoised_brighter"] = std::to_string(config.restraint.brighter);
}

// U = low(x, D), D and h of the auxiliary branch; the picture = upsampled(U, h) around the base image of metrics.md.
void forward(Layers& layers, FrameShape frame) {
  const NetworkConfig& config = layers.config;
  Graph& graph = layers.graph;
  const Prepared prepared = prepareInputs(config, frame, layers.graphOptions, graph);
  graph.output = graph.create("output", DataType::f32, {config.scale * frame.height, config.scale * frame.width, 4});
  TensorView u, h, prefiltered;
  if (config.groups > 0) {
    const AuxiliaryFeatures aux = prepared.aux.exists() ? auxiliaryBranch(layers, prepared.aux) : AuxiliaryFeatures{};
    u = lowResolutionBranch(layers, prepared.x, aux.d);
    h = aux.h;
  }
  if (config.prefilter > 0) {
    const uint32_t logits = config.prefilterLogits();
    const TensorView into = layers.create("prefilter", u, alignUp(logits, 4));
    prefiltered = prefilteredColour(config, graph, prepared, layers.conv1x1("prefilter", u, logits, into));
  }
  upsample(layers, u, h, prepared, prefiltered);
}

}  // namespace

const Architecture kXrds{"xrds", parse, describe, forward};

}  // namespace xrds
