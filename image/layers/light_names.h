#pragma once

#include <string>
#include <string_view>

namespace xrds {

/// What a layer is by the name that Cycles gives it, short (DiffDir) or long (Diffuse Direct).
struct LightName {
  enum class Kind : uint8_t { none, light, colour, group };  // group: Combined_NAME, the light of a light group
  Kind kind = Kind::none;
  std::string colour{};       // of a light: the name of the colour pass that multiplies it, where it has one
  bool followsAlbedo = true;  // of a light without a colour
};

/// `name`: a layer's own, without view layer. Kind::none where Cycles has no light of this name.
LightName lightName(std::string_view name);

/// Whether that is a light or a light group.
bool isLight(std::string_view name);

}  // namespace xrds
