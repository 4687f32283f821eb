#include "network/published.h"

#include "network/fields.h"
#include "xrds/error.h"

namespace xrds {
namespace {

Metadata upscaler(const char* architecture, const Metadata& own) {
  Metadata fields{{"architecture", architecture}, {"scale", "4"}, {"channels", "64"}, {"transfer", "none"}};
  for (const auto& [key, value] : own) fields[key] = value;
  return fields;
}

const std::map<std::string, Metadata>& allFields() {
  static const std::map<std::string, Metadata> kFields{
      {"edsr", upscaler("edsr", {{"channels", "256"}, {"blocks", "32"}, {"residual_divisor", "10"}, {"range", "255"}})},
      {"edsr_baseline", upscaler("edsr", {{"blocks", "16"}, {"residual_divisor", "1"}, {"range", "255"}})},
      {"rcan", upscaler("rcan", {{"groups", "10"}, {"blocks", "20"}, {"reduction", "16"}, {"range", "255"}})},
      {"swinir", upscaler("swinir", {{"channels", "180"},
                                     {"groups", "6"},
                                     {"blocks", "6"},
                                     {"window", "8"},
                                     {"head_channels", "30"},
                                     {"mlp_ratio", "2"},
                                     {"upsampler", "pixelshuffle"},
                                     {"range", "1"}})},
      {"swinir_light", upscaler("swinir", {{"channels", "60"},
                                           {"groups", "4"},
                                           {"blocks", "6"},
                                           {"window", "8"},
                                           {"head_channels", "10"},
                                           {"mlp_ratio", "2"},
                                           {"upsampler", "pixelshuffledirect"},
                                           {"range", "1"}})},
      {"msspl", upscaler("msspl", {{"groups", "3"}, {"blocks", "5"}, {"aux_inputs", "albedo,normal"}})},
      {"oidn",
       {{"architecture", "oidn"},
        {"scale", "1"},
        {"size", "base"},
        {"input", "hdr"},
        {"aux_inputs", "albedo,normal"}}}};
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
    throw Error("Expected a network of " + joinedList(publishedNames()) + ", found '" + name + "'.");
  Metadata fields = found->second;
  fields["format"] = "xrds";
  fields["version"] = "1";
  return fields;
}

NetworkModel readOrPublished(const std::string& pathOrName) {
  if (pathOrName.ends_with(".safetensors")) return NetworkModel::read(pathOrName);
  return NetworkModel::random(parseConfig(publishedFields(pathOrName)), 1);
}

}  // namespace xrds
