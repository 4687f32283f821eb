#include "network/fields.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "xrds/error.h"

namespace xrds {

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

void checkAuxiliaryInputs(const NetworkConfig& config) {
  const std::vector<std::string>& inputs = config.auxInputs;
  require(inputs.size() <= 8, "names more than 8 auxiliary inputs");
  for (const std::string& name : inputs)
    require(!name.empty() && std::count(inputs.begin(), inputs.end(), name) == 1,
            "names an auxiliary input twice or not at all");
}

std::vector<std::string> splitList(const std::string& text) {
  std::vector<std::string> names;
  std::stringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  return names;
}

std::string joinedList(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

}  // namespace xrds
