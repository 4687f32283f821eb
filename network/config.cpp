#include "network/config.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <sstream>

#include "xrds/auxiliary_input.h"
#include "xrds/error.h"

namespace xrds {
namespace {

constexpr const char* kTransfers[] = {"none", "log1p"};
constexpr const char* kBases[] = {"none", "bicubic", "demodulated", "guided"};
constexpr const char* kBlocks[] = {"rdst", "rstb", "rdb"};
constexpr const char* kCrosses[] = {"attention", "concat"};

void require(bool condition, const std::string& message) {
  if (!condition) throw Error("The model file " + message + ".");
}

const std::string& field(const Metadata& metadata, const char* key) {
  const auto found = metadata.find(key);
  require(found != metadata.end(), std::string("has no field '") + key + "' in its metadata");
  return found->second;
}

uint32_t number(const Metadata& metadata, const char* key, uint32_t low, uint32_t high) {
  const std::string& text = field(metadata, key);
  uint32_t result = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result);
  require(error == std::errc{} && end == text.data() + text.size() && result >= low && result <= high,
          "gives " + std::string(key) + " '" + text + "', expected a number from " + std::to_string(low) + " to " +
              std::to_string(high));
  return result;
}

uint32_t numberOr(const Metadata& metadata, const char* key, uint32_t fallback, uint32_t high) {
  return metadata.contains(key) ? number(metadata, key, 0, high) : fallback;
}

template <size_t count>
size_t choice(const Metadata& metadata, const char* key, const char* const (&names)[count]) {
  const std::string& text = field(metadata, key);
  const auto found = std::find(std::begin(names), std::end(names), text);
  require(found != std::end(names), "gives " + std::string(key) + " '" + text + "', which this version does not know");
  return static_cast<size_t>(found - std::begin(names));
}

// The first name is that of the paper, which a file need not state.
template <size_t count>
size_t choiceOrFirst(const Metadata& metadata, const char* key, const char* const (&names)[count]) {
  return metadata.contains(key) ? choice(metadata, key, names) : 0;
}

std::vector<std::string> splitList(const std::string& text) {
  std::vector<std::string> names;
  std::stringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  return names;
}

void checkCombination(const NetworkConfig& config) {
  require(std::has_single_bit(config.scale),
          "gives scale " + std::to_string(config.scale) + ", expected 1, 2, 4, 8 or 16");
  require(config.channels % 4 == 0 && config.auxChannels % 4 == 0 && config.headChannels % 4 == 0,
          "gives channels that are no multiples of 4");
  require(config.channels % config.headChannels == 0, "gives channels that are no multiple of head_channels");
  require(config.window % 2 == 0, "gives an odd window");
  require(config.auxInputs.size() <= 8, "names more than 8 auxiliary inputs");
  for (const auto& name : config.auxInputs)
    require(!name.empty() && std::count(config.auxInputs.begin(), config.auxInputs.end(), name) == 1,
            "names an auxiliary input twice or not at all");
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
  require(!config.auxSkip || !config.auxInputs.empty(), "has an auxiliary skip but no auxiliary input");
}

}  // namespace

std::vector<size_t> NetworkConfig::radianceInputs() const {
  std::vector<size_t> found;
  for (size_t i = 0; i < auxInputs.size(); ++i)
    if (const AuxiliaryInput* kind = findAuxiliaryInput(auxInputs[i]); kind && kind->isRadiance) found.push_back(i);
  return found;
}

uint32_t NetworkConfig::steps() const { return static_cast<uint32_t>(std::countr_zero(scale)); }

int NetworkConfig::auxOffset(std::string_view name) const {
  const auto found = std::find(auxInputs.begin(), auxInputs.end(), name);
  return found == auxInputs.end() ? -1 : 3 * static_cast<int>(found - auxInputs.begin());
}

NetworkConfig parseConfig(const Metadata& metadata) {
  require(field(metadata, "format") == "xrds", "is of another format, expected 'xrds' in its metadata");
  require(field(metadata, "version") == "1",
          "has version '" + field(metadata, "version") + "', this program reads version 1");
  NetworkConfig config;
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
  checkCombination(config);
  return config;
}

Metadata describe(const NetworkConfig& config) {
  std::string inputs;
  for (const auto& name : config.auxInputs) inputs += (inputs.empty() ? "" : ",") + name;
  return {{"format", "xrds"},
          {"version", "1"},
          {"scale", std::to_string(config.scale)},
          {"channels", std::to_string(config.channels)},
          {"aux_channels", std::to_string(config.auxChannels)},
          {"aux_inputs", inputs},
          {"groups", std::to_string(config.groups)},
          {"blocks", std::to_string(config.blocks)},
          {"window", std::to_string(config.window)},
          {"head_channels", std::to_string(config.headChannels)},
          {"transfer", kTransfers[static_cast<size_t>(config.transfer)]},
          {"base", kBases[static_cast<size_t>(config.base)]},
          {"block", kBlocks[static_cast<size_t>(config.block)]},
          {"cross", kCrosses[static_cast<size_t>(config.cross)]},
          {"kernels", std::to_string(config.kernels)},
          {"aux_skip", config.auxSkip ? "1" : "0"},
          {"aux_kernels", std::to_string(config.auxKernels)},
          {"colour_kernels", std::to_string(config.colourKernels)},
          {"prefilter", std::to_string(config.prefilter)},
          {"output_side", std::to_string(config.outputSide)}};
}

}  // namespace xrds
