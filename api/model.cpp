#include "api/model.h"

#include <algorithm>
#include <cstdio>

#include "api/arguments.h"
#include "engine/kernel_family.h"
#include "frames/session.h"
#include "frames/tile_choice.h"
#include "network/halo.h"
#include "xrds/error.h"

namespace xrds {
namespace {

FrameShape frameOf(const NetworkConfig& config, uint32_t outputWidth, uint32_t outputHeight) {
  if (outputWidth % config.scale != 0 || outputHeight % config.scale != 0)
    throw InvalidArgument("An output of " + sizeText(outputWidth, outputHeight) +
                          " pixels is no multiple of the model's scale " + std::to_string(config.scale) + ".");
  return {outputHeight / config.scale, outputWidth / config.scale};
}

// Columns and rows that the frame cannot be cut into would be fewer without a word.
void checkGrid(const TileOptions& asked, const Tiling& found, FrameShape frame) {
  const auto check = [&](const char* name, uint32_t wanted, uint32_t possible) {
    if (wanted > possible)
      throw InvalidArgument("A frame of " + sizeText(frame.width, frame.height) + " pixels cannot be cut into " +
                            std::to_string(wanted) + " " + name + " of tiles: whole windows and a halo of " +
                            std::to_string(found.halo) + " pixels make " + std::to_string(possible) +
                            "; ask for fewer, or for 0.");
  };
  check("columns", asked.columns, found.columns);
  check("rows", asked.rows, found.rows);
}

}  // namespace

Tiling tilingOf(const NetworkModel& model, FrameShape frame, bool fp16, const TileOptions& options,
                const MemoryLimits& limits) {
  const NetworkConfig& config = model.config();
  if (options.exact && std::max(options.columns, options.rows) > 1 && seesWholeFrame(config))
    throw InvalidArgument(
        "Exact tiles were asked for, but each pixel that this model makes depends on the whole frame (its " +
        config.architecture + " network takes global means): ask for bounded tiles, or for one tile.");
  const uint32_t halo = options.halo.value_or(options.exact ? exactHalo(config) : boundedHalo(config));
  if (halo % config.window != 0)
    throw InvalidArgument("A halo of " + std::to_string(halo) +
                          " pixels was asked for, expected a multiple of the model's window, " +
                          std::to_string(config.window) + ".");
  const TileChoice choice = chooseTiles(model, frame, fp16 ? Precision::fp16 : Precision::fp32,
                                        {options.columns, options.rows, halo, options.wrap}, limits);
  const std::vector<Tile> tiles = cutFrame(frame, config.window, choice.cut);
  const auto columns = static_cast<uint32_t>(
      std::count_if(tiles.begin(), tiles.end(), [](const Tile& tile) { return tile.inner.y == 0; }));
  Tiling tiling{.columns = columns, .rows = static_cast<uint32_t>(tiles.size()) / columns, .halo = halo};
  checkGrid(options, tiling, frame);
  if (tiling.columns * tiling.rows == 1 && !options.wrap) tiling.halo = 0;
  tiling.tileWidth = config.scale * choice.crop.width;
  tiling.tileHeight = config.scale * choice.crop.height;
  tiling.work = choice.work;
  tiling.arenaBytes = choice.arenaByteSize;
  tiling.weightBytes = choice.weightByteSize;
  return tiling;
}

NetworkModel untrainedModel(uint32_t scale, const std::string& base, const std::string& transfer) {
  NetworkConfig none{.scale = scale, .groups = 0};
  if (base == "bicubic") none.auxInputs.clear();
  Metadata metadata = describe(none);
  metadata["base"] = base;
  metadata["transfer"] = transfer;
  TensorFile file;
  file.metadata = std::move(metadata);
  return NetworkModel::fromTensors(std::move(file), "untrained model");
}

std::string hashText(const NetworkModel& model) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(model.file().hash));
  return text;
}

Model::Cost costOf(const NetworkModel& model, uint32_t outputWidth, uint32_t outputHeight, bool fp16,
                   const std::string& kernelFamily) {
  const NetworkConfig& config = model.config();
  const FrameShape frame = frameOf(config, outputWidth, outputHeight);
  const DeviceTraits device = usualTraits(kernelFamilyOf(kernelFamily));
  const auto graphOf = [&](const GraphOptions& options) { return buildGraph(config, frame, model.lookup(), options); };
  const Graph graph = graphOf(fastOn(device, {fp16 ? Precision::fp16 : Precision::fp32}));
  const NodeCost executed = xrds::cost(graph);
  Model::Cost sum{.parameters = model.parameterCount(),
                  .networkMultiplyAdds = xrds::cost(graphOf(kAsWritten)).multiplyAdds,
                  .multiplyAdds = executed.multiplyAdds,
                  .attentionMultiplyAdds = executed.attentionMultiplyAdds};
  const MemoryNeeds needs = memoryNeeds(graph, device);
  sum.plannedBytes = needs.planned;
  sum.lowerBoundBytes = needs.lowerBound;
  sum.unaliasedBytes = needs.unaliased;
  sum.weightBytes = needs.weights;
  return sum;
}

Tiling planTiles(const NetworkModel& model, uint32_t outputWidth, uint32_t outputHeight, bool fp16,
                 const TileOptions& options, const std::string& kernelFamily) {
  const FrameShape frame = frameOf(model.config(), outputWidth, outputHeight);
  checkOptions(options);
  checkShape(model.config(), frame);
  constexpr uint64_t kNoLimit = uint64_t{1} << 50;
  MemoryLimits limits{options.memoryBytes ? options.memoryBytes : kNoLimit, usualTraits(kernelFamilyOf(kernelFamily))};
  limits.traits.maxAllocationBytes = limits.traits.maxTexelBufferElements = kNoLimit;
  return tilingOf(model, frame, fp16, options, limits);
}

}  // namespace xrds
