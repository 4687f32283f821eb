#include "image/aov_names.h"

#include <algorithm>
#include <cctype>
#include <span>
#include <stdexcept>

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
    {"basecolor", 6},  // plain words
};

constexpr RankedName kNormalNames[] = {
    {"denoising_normal", 0},    // Cycles
    {"ns", 1},                  // pbrt, shading normal
    {"sh_normal", 1},           // Mitsuba
    {"avg_shading_normal", 1},  // LuxCore
    {"denoise_normal", 2},      // plain word
    {"shading_normal", 3},      // LuxCore, one sample
    {"normal", 4},
    {"normals", 4},  // RenderMan, plain words
    {"n", 5},
    {"nn", 5},       // Arnold, Karma; Mitsuba's manual
    {"n_noice", 6},  // Arnold, for its own denoiser
    {"geo_normal", 7},
    {"geometry_normal", 7},  // unshaded normals, when there is nothing better
};

constexpr RankedName kDepthNames[] = {
    {"denoising_depth", 0},  // Cycles, through mirrors and glass as the other denoising passes
    {"depth", 1},            // Cycles, LuxCore, plain word
    {"z", 2},                // Arnold, RenderMan, Karma and most others
};

std::span<const RankedName> namesOf(AovRole role) {
  switch (role) {
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
    default:
      return std::string(kNormal.name);
  }
}

AovRole roleOf(std::string_view auxiliaryInput) {
  if (auxiliaryInput == kFullColour.name) return AovRole::kFullColor;  // its words are not the input's name
  for (const AovRole role : {AovRole::kAlbedo, AovRole::kNormal, AovRole::kDepth}) {
    if (toString(role) == auxiliaryInput) {
      return role;
    }
  }
  throw std::logic_error("no layer is the auxiliary input " + std::string(auxiliaryInput));
}

std::string plainName(std::string_view name) {
  std::string plain(name);
  std::transform(plain.begin(), plain.end(), plain.begin(), [](unsigned char letter) {
    return letter == ' ' || letter == '-' ? '_' : static_cast<char>(std::tolower(letter));
  });
  return plain;
}

std::optional<int> aovRank(AovRole role, std::string_view name) {
  const std::string plain = plainName(name);
  for (const RankedName& known : namesOf(role)) {
    if (known.name == plain) {
      return known.rank;
    }
  }
  return std::nullopt;
}

bool namesNoisyRender(std::string_view name) { return plainName(name) == "noisy_image"; }
bool namesFinishedRender(std::string_view name) { return plainName(name) == "combined"; }

}  // namespace xrds
