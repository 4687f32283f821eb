#pragma once

#include <string_view>

namespace xrds {

/// An image at full resolution that models may take beside the colour, three channels each; Model::auxiliaryInputs()
/// names those of a model.
struct AuxiliaryInput {
  std::string_view name;       // in model files
  std::string_view meaning;    // for people
  bool isReflectance = false;  // clamped to [0, 4]; base images may divide the colour by it
  bool isDirection = false;    // unit vectors in the camera's axes, which turn along when the image is mirrored
  bool isDistance = false;     // one channel of distances in files, of which relativeDepth() makes three
  bool isRadiance = false;     // noisy light of the render that the others are of: as bright as its colour
};

inline constexpr AuxiliaryInput kAlbedo{.name = "albedo", .meaning = "albedo", .isReflectance = true};
inline constexpr AuxiliaryInput kNormal{.name = "normal", .meaning = "normal", .isDirection = true};
inline constexpr AuxiliaryInput kDepth{.name = "depth", .meaning = "depth, distances in any unit", .isDistance = true};
/// The light that diffuse and glossy surfaces send on, direct and indirect, per unit of albedo.
inline constexpr AuxiliaryInput kDiffuse{
    .name = "diffuse", .meaning = "diffuse light, without the albedo", .isRadiance = true};
inline constexpr AuxiliaryInput kGlossy{
    .name = "glossy", .meaning = "glossy light, without the colour of the surface", .isRadiance = true};
/// A model that takes it expects mergedColour() of both in the place of the low-resolution colour.
inline constexpr AuxiliaryInput kFullColour{.name = "colour", .meaning = "full-resolution colour", .isRadiance = true};
/// Every kind.
inline constexpr AuxiliaryInput kAuxiliaryInputs[] = {kAlbedo, kNormal, kDepth, kDiffuse, kGlossy, kFullColour};

/// The input of that name; nullptr if there is none.
constexpr const AuxiliaryInput* findAuxiliaryInput(std::string_view name) {
  for (const AuxiliaryInput& input : kAuxiliaryInputs)
    if (input.name == name) return &input;
  return nullptr;
}

}  // namespace xrds
