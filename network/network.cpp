#include "network/network.h"

#include <algorithm>

#include "graph/promotion.h"
#include "network/architecture.h"
#include "xrds/error.h"

namespace xrds {

namespace {

// Dispatches that fill any GPU, unless its memory is short: a pixel of a band takes a few KB, of the widest models 30.
uint32_t bandPixels(const DeviceTraits& device) {
  constexpr uint64_t kLeast = uint64_t{1} << 14, kMost = uint64_t{1} << 17, kBytesPerPixel = uint64_t{1} << 16;
  const uint64_t pixels = device.memoryBytes / kBytesPerPixel;
  return pixels < kLeast ? 0 : static_cast<uint32_t>(std::min(pixels, kMost));
}

}  // namespace

GraphOptions fastOn(const DeviceTraits& device, GraphOptions options) {
  const KernelTable& tuned = options.kernels;
  options.normsInLinear = tuned.normsInLinear.value_or(device.family == KernelFamily::lane);
  options.mapsJoined = true;
  options.inSquares = device.family == KernelFamily::lane;
  options.bandPixels = bandPixels(device);
  if (tuned.layersFused.value_or(device.family == KernelFamily::fused)) {
    options.layersFusedOn = device;
    options.layersFusedOn->family = KernelFamily::fused;
  }
  return options;
}

Graph buildGraph(const NetworkConfig& config, FrameShape frame, const WeightLookup& weights,
                 const GraphOptions& options) {
  if (frame.height == 0 || frame.width == 0 || frame.height > kMaxSide / config.scale ||
      frame.width > kMaxSide / config.scale)
    throw InvalidArgument("A frame of " + std::to_string(frame.width) + " x " + std::to_string(frame.height) +
                          " pixels cannot be upscaled by " + std::to_string(config.scale) +
                          ": each side of the output must be 1 to 65536 pixels.");
  Graph graph;
  if (options.precision == Precision::fp16 && config.groups > 0)
    graph.promoted =
        findPromotions(buildGraph(config, {1, 1}, weights, {.autoExposure = false, .mapsJoined = options.mapsJoined}));
  Layers layers(config, weights, graph, options);
  architectureOf(config).forward(layers, frame);
  if (graph.layers.size() != options.layers)
    throw InvalidArgument(
        "Layers cannot be upscaled by this model: its architecture has no base image whose kernels they take.");
  chooseKernels(graph, options.kernels);
  return graph;
}

}  // namespace xrds
