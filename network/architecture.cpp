#include "network/architecture.h"

#include "network/fields.h"

namespace xrds {

const Architecture& architectureOf(const NetworkConfig& config) {
  for (const Architecture* architecture : {&kXrds, &kOidn, &kEdsr, &kRcan, &kSwinIr, &kMsspl})
    if (config.architecture == architecture->name) return *architecture;
  require(false, "is of the architecture '" + config.architecture + "', which this version does not know");
  return kXrds;
}

}  // namespace xrds
