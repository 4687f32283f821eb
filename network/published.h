#pragma once

#include "network/network_model.h"

namespace xrds {

/// Networks of others, of the sizes that their papers state, at scale 4, and Open Image Denoise's base: what can be
/// counted, timed and compiled without their weights.
const std::vector<std::string>& publishedNames();

/// The metadata fields of such a network. Throws Error for another name.
Metadata publishedFields(const std::string& name);

/// The model of the file, or that of the name with random weights. Throws Error if it is neither.
NetworkModel readOrPublished(const std::string& pathOrName);

}  // namespace xrds
