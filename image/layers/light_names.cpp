#include "image/layers/light_names.h"

#include <algorithm>
#include <array>
#include <utility>

namespace xrds {
namespace {

using Pair = std::pair<std::string_view, std::string_view>;

constexpr std::string_view kWithColour[] = {"Diff", "Gloss", "Trans", "Subsurface"};
constexpr std::string_view kWithColourLong[] = {"Diffuse", "Glossy", "Transmission", "Subsurface"};
constexpr std::string_view kAlone[] = {"Emit",     "Env",         "VolumeDir",     "VolumeInd",
                                       "Emission", "Environment", "Volume Direct", "Volume Indirect"};
constexpr std::string_view kGroup = "Combined_";

template <size_t n>
LightName lightOf(std::string_view name, const std::string_view (&stems)[n], Pair lights, std::string_view colour) {
  for (const std::string_view stem : stems) {
    if (!name.starts_with(stem)) continue;
    const std::string_view end = name.substr(stem.size());
    if (end == colour) return {LightName::Kind::colour};
    if (end == lights.first || end == lights.second)
      return {LightName::Kind::light, std::string(stem) + std::string(colour)};
  }
  return {};
}

}  // namespace

LightName lightName(std::string_view name) {
  if (name.starts_with(kGroup)) return {LightName::Kind::group};
  if (std::find(std::begin(kAlone), std::end(kAlone), name) != std::end(kAlone))
    return {LightName::Kind::light, {}, false};
  if (LightName found = lightOf(name, kWithColour, {"Dir", "Ind"}, "Col"); found.kind != LightName::Kind::none)
    return found;
  return lightOf(name, kWithColourLong, {" Direct", " Indirect"}, " Color");
}

bool isLight(std::string_view name) {
  const LightName::Kind kind = lightName(name).kind;
  return kind == LightName::Kind::light || kind == LightName::Kind::group;
}

}  // namespace xrds
