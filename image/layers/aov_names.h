#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace xrds {

/// What a layer is to the upscaler.
enum class AovRole { kColor, kAlbedo, kNormal, kDepth, kDiffuse, kGlossy, kFullColor };

/// The role in words: "colour", "albedo", "normal", "depth", "diffuse light", "glossy light" or
/// "full-resolution colour".
std::string toString(AovRole role);

/// The role of a model's auxiliary input (AuxiliaryInput::name). Throws std::logic_error if no layer has it.
[[nodiscard]] AovRole roleOf(std::string_view auxiliaryInput);

/// How well a layer's own name (what follows its last dot, any case; spaces and hyphens count as underscores, but for
/// lights) fits a role by the conventions of Cycles, pbrt, Mitsuba, Arnold, RenderMan, LuxCore, Karma, Redshift, V-Ray
/// and by plain words: 0 is best; nothing when the name says nothing about the role. The name may be empty, as that of
/// pbrt's colour is.
std::optional<int> aovRank(AovRole role, std::string_view name);

/// The name of the indirect light that goes with a layer of direct light of this own name: Cycles' "DiffInd"
/// with "DiffDir"; nothing where the name is not one of direct light.
std::optional<std::string> indirectLightName(AovRole role, std::string_view name);

/// Lower case, with spaces and hyphens as underscores: the form in which names are compared.
std::string plainName(std::string_view name);

/// Whether the name, in plain form, is that of Cycles' render before denoising.
bool namesNoisyRender(std::string_view name);

/// Whether the name, in plain form, is that of Cycles' render as it leaves the renderer, denoised or not.
bool namesFinishedRender(std::string_view name);

}  // namespace xrds
