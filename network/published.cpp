#include "network/published.h"

#include "network/architecture.h"
#include "network/fields.h"
#include "xrds/error.h"
#include "xrds/path_text.h"

namespace xrds {
namespace {

const std::map<std::string, Metadata>& allFields() {
  static const std::map<std::string, Metadata> kFields = [] {
    std::map<std::string, Metadata> fields;
    for (const Architecture* architecture : kArchitectures)
      for (const PublishedNetwork& network : architecture->published)
        fields[network.name] = metadataOf(*architecture, network.fields);
    return fields;
  }();
  return kFields;
}

}  // namespace

const std::vector<std::string>& publishedNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& [name, fields] : allFields()) names.push_back(name);
    return names;
  }();
  return kNames;
}

Metadata publishedFields(const std::string& name) {
  const auto found = allFields().find(name);
  if (found == allFields().end())
    throw InvalidArgument("Expected a network of " + joinedList(publishedNames()) + ", found '" + name + "'.");
  return found->second;
}

NetworkModel readOrPublished(const std::string& pathOrName) {
  if (pathOrName.ends_with(".safetensors")) return NetworkModel::read(pathOf(pathOrName));
  return NetworkModel::random(parseConfig(publishedFields(pathOrName)), 1);
}

}  // namespace xrds
