#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "network/config.h"

namespace xrds {

/// Throws Error "The model file MESSAGE." unless the condition holds.
void require(bool condition, const std::string& message);

/// A field of a model file's metadata. Throws Error if it is not there.
const std::string& field(const Metadata& metadata, const char* key);

/// A field that is a whole number of that range. Throws Error if it is another or not there.
uint32_t number(const Metadata& metadata, const char* key, uint32_t low, uint32_t high);

/// The same of a field that need not be there, from 0 on.
uint32_t numberOr(const Metadata& metadata, const char* key, uint32_t fallback, uint32_t high);

/// Which of the names the field is. Throws Error if it is none of them.
template <size_t count>
size_t choice(const Metadata& metadata, const char* key, const char* const (&names)[count]) {
  const std::string& text = field(metadata, key);
  const auto found = std::find(std::begin(names), std::end(names), text);
  require(found != std::end(names), "gives " + std::string(key) + " '" + text + "', which this version does not know");
  return static_cast<size_t>(found - std::begin(names));
}

/// The same of a field that need not be there: then it is the first.
template <size_t count>
size_t choiceOrFirst(const Metadata& metadata, const char* key, const char* const (&names)[count]) {
  return metadata.contains(key) ? choice(metadata, key, names) : 0;
}

/// Throws Error if the auxiliary inputs are too many, or one is named twice or not at all.
void checkAuxiliaryInputs(const NetworkConfig& config);

/// The names of a comma-separated list, and the inverse.
std::vector<std::string> splitList(const std::string& text);
std::string joinedList(const std::vector<std::string>& names);

}  // namespace xrds
