#include "image/layers/aov_names.h"

#include <algorithm>
#include <cctype>
#include <span>
#include <stdexcept>
#include <utility>

#include "xrds/auxiliary_input.h"

namespace xrds {
namespace {

constexpr int kUnnamedColor = 2;

struct RankedName {
  std::string_view name;
  int rank;
};

// Cycles keeps the raw render beside a denoised Combined. The two share a rank, so that two view layers of which only
// one was denoised stay ambiguous; the choice within one view layer is made where layers are compared.
constexpr RankedName kColorNames[] = {
    {"noisy_image", 0},  // Cycles, when it denoises
    {"combined", 0},     // Cycles
    {"rgba", 1},         // Arnold
    {"rgb", 1},
    {"beauty", 1},
    {"main", 1},
    {"ci", 1},            // RenderMan
    {"c", 1},             // Karma
    {"", kUnnamedColor},  // pbrt, Mitsuba, Arnold and most others
    {"color", 3},         // plain words, which beside an unnamed layer mean something else
    {"colour", 3},
    {"radiance", 3},
    {"image", 4},  // Mitsuba's nested integrator, by habit
};

constexpr RankedName kAlbedoNames[] = {
    {"denoising_albedo", 0},      // Cycles
    {"denoise_albedo", 1},        // Arnold
    {"albedo", 2},                // pbrt, Mitsuba, RenderMan, LuxCore
    {"denoise_albedo_noice", 3},  // Arnold, for its own denoiser
    {"diffuse_albedo", 4},
    {"diffuse_albedo_noice", 5},  // Arnold
    {"base_color", 6},
    {"basecolor", 6},          // plain words
    {"diffusefilter", 7},      // Redshift
    {"vraydiffusefilter", 7},  // V-Ray in 3ds Max
};

constexpr RankedName kNormalNames[] = {
    {"denoising_normal", 0},    // Cycles
    {"ns", 1},                  // pbrt, shading normal
    {"sh_normal", 1},           // Mitsuba
    {"avg_shading_normal", 1},  // LuxCore
    {"denoise_normal", 2},      // plain word
    {"shading_normal", 3},      // LuxCore, one sample
    {"bumpnormals", 3},         // Redshift
    {"bump_normals", 3},        // V-Ray
    {"vraybumpnormals", 3},     // V-Ray in 3ds Max
    {"normal", 4},
    {"normals", 4},      // RenderMan, Redshift, V-Ray, plain words
    {"vraynormals", 4},  // V-Ray in 3ds Max
    {"n", 5},
    {"nn", 5},       // Arnold, Karma; Mitsuba's manual
    {"n_noice", 6},  // Arnold, for its own denoiser
    {"geo_normal", 7},
    {"geometry_normal", 7},  // unshaded normals, when there is nothing better
};

constexpr RankedName kDepthNames[] = {
    {"denoising_depth", 0},  // Cycles, through mirrors and glass as the other denoising passes
    {"depth", 1},            // Cycles, LuxCore, plain word
    {"dd", 2},               // Mitsuba's manual
    {"z", 2},                // Arnold, RenderMan, Karma, Redshift and most others
};

// Cycles' alone: it divides its lights by the albedo. Arnold's diffuse_direct, which is told from Blender 5's "Diffuse
// Direct" by its underscore, holds the albedo.
constexpr RankedName kDiffuseNames[] = {{"diffdir", 0}, {"diffuse direct", 0}};
constexpr RankedName kGlossyNames[] = {{"glossdir", 0}, {"glossy direct", 0}};

std::span<const RankedName> namesOf(AovRole role) {
  switch (role) {
    case AovRole::kDiffuse:
      return kDiffuseNames;
    case AovRole::kGlossy:
      return kGlossyNames;
    case AovRole::kColor:
    case AovRole::kFullColor:
      return kColorNames;
    case AovRole::kAlbedo:
      return kAlbedoNames;
    case AovRole::kDepth:
      return kDepthNames;
    default:
      return kNormalNames;
  }
}

bool isLight(AovRole role) { return role == AovRole::kDiffuse || role == AovRole::kGlossy; }

std::string lowerCase(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return lower;
}

}  // namespace

std::string toString(AovRole role) {
  switch (role) {
    case AovRole::kColor:
      return "colour";
    case AovRole::kFullColor:
      return "full-resolution colour";
    case AovRole::kAlbedo:
      return std::string(kAlbedo.name);
    case AovRole::kDepth:
      return std::string(kDepth.name);
    case AovRole::kDiffuse:
      return "diffuse light";
    case AovRole::kGlossy:
      return "glossy light";
    default:
      return std::string(kNormal.name);
  }
}

AovRole roleOf(std::string_view auxiliaryInput) {
  constexpr std::pair<AuxiliaryInput, AovRole> kRoles[] = {
      {kAlbedo, AovRole::kAlbedo},   {kNormal, AovRole::kNormal}, {kDepth, AovRole::kDepth},
      {kDiffuse, AovRole::kDiffuse}, {kGlossy, AovRole::kGlossy}, {kFullColour, AovRole::kFullColor}};
  for (const auto& [input, role] : kRoles)
    if (input.name == auxiliaryInput) return role;
  throw std::logic_error("no layer is the auxiliary input " + std::string(auxiliaryInput));
}

std::string plainName(std::string_view name) {
  std::string plain = lowerCase(name);
  std::replace_if(
      plain.begin(), plain.end(), [](char letter) { return letter == ' ' || letter == '-'; }, '_');
  return plain;
}

std::optional<int> aovRank(AovRole role, std::string_view name) {
  const std::string plain = isLight(role) ? lowerCase(name) : plainName(name);
  for (const RankedName& known : namesOf(role)) {
    if (known.name == plain) {
      return known.rank;
    }
  }
  return std::nullopt;
}

std::optional<std::string> indirectLightName(AovRole role, std::string_view name) {
  if (!isLight(role) || !aovRank(role, name)) return std::nullopt;
  const bool isShort = lowerCase(name).ends_with("dir");
  name.remove_suffix(isShort ? 3 : 6);
  return std::string(name) + (isShort ? "Ind" : "Indirect");
}

bool namesNoisyRender(std::string_view name) { return plainName(name) == "noisy_image"; }
bool namesFinishedRender(std::string_view name) { return plainName(name) == "combined"; }

}  // namespace xrds
