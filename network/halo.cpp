#include "network/halo.h"

#include <algorithm>
#include <deque>
#include <vector>

#include "graph/reach.h"
#include "network/network.h"

namespace xrds {

uint32_t exactHalo(const NetworkConfig& config) {
  std::deque<std::vector<float>> zeros;  // how far a network sees is a matter of its layers, not of their weights
  const WeightLookup lookup = [&](const std::string&, std::span<const uint32_t> shape) -> std::span<const float> {
    size_t count = 1;
    for (const uint32_t side : shape) count *= side;
    return zeros.emplace_back(count);
  };
  GraphOptions options = kAsWritten;
  options.autoExposure = false;  // crops take that of the whole frame
  const Graph graph = buildGraph(config, {config.window, config.window}, lookup, options);
  const uint32_t output = firstExactPixels(graph)[graph.output.value];
  return alignUp(ceilDivide(output, config.scale), config.window);
}

bool seesWholeFrame(const NetworkConfig& config) { return exactHalo(config) >= kWholeImage / config.scale; }

uint32_t boundedHalo(const NetworkConfig& config) {
  constexpr uint32_t kLeast = 16;
  return std::min(std::max(2 * config.window, alignUp(kLeast, config.window)), exactHalo(config));
}

}  // namespace xrds
