#pragma once

#include "network/layers.h"

namespace xrds {

/// A network that a model file may be of: how its metadata states the symbols, and the forward pass.
struct Architecture {
  const char* name;                                   // field `architecture` of the model file
  void (*parse)(const Metadata&, NetworkConfig&);     // its fields of the metadata; throws Error
  void (*describe)(const NetworkConfig&, Metadata&);  // the inverse
  /// Adds the inputs, the nodes and Graph::output to the graph of the layers.
  void (*forward)(Layers&, FrameShape);
};

/// Each in the file of its name.
extern const Architecture kXrds, kOidn, kEdsr, kRcan, kSwinIr, kMsspl;

/// That of the config. Throws Error if there is none of that name.
const Architecture& architectureOf(const NetworkConfig& config);

}  // namespace xrds
