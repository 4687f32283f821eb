#include "network/config.h"

#include <algorithm>
#include <bit>

#include "network/architecture.h"
#include "network/fields.h"
#include "xrds/auxiliary_input.h"

namespace xrds {

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

uint32_t NetworkConfig::symbol(const std::string& name) const {
  const auto found = symbols.find(name);
  return found == symbols.end() ? 0 : found->second;
}

NetworkConfig parseConfig(const Metadata& metadata) {
  require(field(metadata, "format") == "xrds", "is of another format, expected 'xrds' in its metadata");
  require(field(metadata, "version") == "1",
          "has version '" + field(metadata, "version") + "', this program reads version 1");
  NetworkConfig config;
  if (metadata.contains("architecture")) config.architecture = field(metadata, "architecture");
  architectureOf(config).parse(metadata, config);
  return config;
}

Metadata describe(const NetworkConfig& config) {
  Metadata metadata{{"format", "xrds"}, {"version", "1"}};
  if (config.architecture != kXrds.name) metadata["architecture"] = config.architecture;
  architectureOf(config).describe(config, metadata);
  return metadata;
}

}  // namespace xrds
