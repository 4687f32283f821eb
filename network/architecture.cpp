#include "network/architecture.h"

#include <sstream>

#include "network/fields.h"

namespace xrds {

const Architecture& architectureOf(const NetworkConfig& config) {
  for (const Architecture* architecture : kArchitectures)
    if (config.architecture == architecture->name) return *architecture;
  require(false, "is of the architecture '" + config.architecture + "', which this version does not know");
  return kXrds;
}

Metadata metadataOf(const Architecture& architecture, std::string_view fields) {
  Metadata metadata{{"format", "xrds"}, {"version", "1"}, {"architecture", architecture.name}};
  std::istringstream text{std::string(fields)};
  for (std::string field; text >> field;) {
    const size_t equals = field.find('=');
    XRDS_CHECK(equals != std::string::npos);
    metadata[field.substr(0, equals)] = field.substr(equals + 1);
  }
  return metadata;
}

}  // namespace xrds
