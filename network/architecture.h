#pragma once

#include <span>
#include <string_view>

#include "network/layers.h"

namespace xrds {

/// A network of the size that a paper states.
struct PublishedNetwork {
  const char* name;
  const char* fields;            // of the metadata, as metadataOf() takes them
  double millionParameters = 0;  // as published, without tables of relative positions; 0: not published
  double gigaMultiplyAdds = 0;   // as others count them for 1280 x 720 pixels of the output; 0: not published
};

/// A network that a model file may be of: how its metadata states the symbols, and the forward pass.
struct Architecture {
  const char* name;                                   // field `architecture` of the model file
  void (*parse)(const Metadata&, NetworkConfig&);     // its fields of the metadata; throws Error
  void (*describe)(const NetworkConfig&, Metadata&);  // the inverse
  /// Adds the inputs, the nodes and Graph::output to the graph of the layers.
  void (*forward)(Layers&, FrameShape);
  std::span<const PublishedNetwork> published{};
  const char* small = nullptr;  // fields of a network that stress runs and tests try
};

/// Each in the file of its name.
extern const Architecture kXrds, kSwinIr, kEdsr, kMsspl, kRcan, kRdn, kOidn;
inline constexpr const Architecture* kArchitectures[] = {&kXrds, &kSwinIr, &kEdsr, &kMsspl, &kRcan, &kRdn, &kOidn};

/// That of the config. Throws Error if there is none of that name.
const Architecture& architectureOf(const NetworkConfig& config);

/// The metadata of a model file of the architecture; fields "blocks=16 channels=64": key=value, separated by spaces.
Metadata metadataOf(const Architecture& architecture, std::string_view fields);

}  // namespace xrds
