#include "image/layers/aov.h"

#include <algorithm>
#include <utility>

#include "image/layers/aov_candidates.h"
#include "image/layers/light_names.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using Candidates = std::vector<AovCandidate>;

bool isColor(AovRole role) { return role == AovRole::kColor || role == AovRole::kFullColor; }

bool isNoisyRender(const AovCandidate& c) { return namesNoisyRender(c.stem); }

// The noisy render of the view layer that a finished render belongs to.
bool hasNoisyTwin(const Candidates& all, const AovCandidate& finished) {
  return namesFinishedRender(finished.stem) && std::any_of(all.begin(), all.end(), [&](const AovCandidate& other) {
           return isNoisyRender(other) && other.prefix == finished.prefix && other.pixelCount == finished.pixelCount &&
                  other.view == finished.view;
         });
}

bool servesAnotherRole(const AovCandidate& candidate) {
  return aovRank(AovRole::kAlbedo, candidate.stem) || aovRank(AovRole::kNormal, candidate.stem) ||
         plainName(candidate.stem).starts_with("crypto");
}

// A colour pass is no colour, and a light, which may be given as one, is not what others are the sum of.
bool isPartOfColour(const AovCandidate& candidate, AovRole role) {
  const LightName::Kind kind = lightName(candidate.stem).kind;
  return kind == LightName::Kind::colour || (role == AovRole::kFullColor && kind != LightName::Kind::none);
}

// An unnamed layer whose part has a name without meaning, such as "low", counts as unnamed.
std::optional<int> rankOf(const AovCandidate& candidate, AovRole role) {
  std::optional<int> rank = aovRank(role, candidate.stem);
  if (!rank && candidate.namedByPart && !servesAnotherRole(candidate)) {
    rank = aovRank(role, "");
  }
  // Blender's compositor adds its own result, under this name, to the layers of the renderer.
  constexpr int kBehindTheRenderers = 50, kBehindColours = 100;
  if (rank && plainName(candidate.prefix) == "composite") {
    *rank += kBehindTheRenderers;
  }
  if (rank && candidate.selection.isGrey()) {
    *rank += kBehindColours;
  }
  return rank;
}

// The best names of all candidates; for colour, failing that, whatever has no other meaning and is not grey, as masks
// are.
Candidates bestByName(const Candidates& all, AovRole role) {
  std::optional<int> best;
  for (const AovCandidate& candidate : all) {
    const std::optional<int> rank = rankOf(candidate, role);
    best = rank && (!best || *rank < *best) ? rank : best;
  }
  Candidates result = all;
  if (best) {
    keepIf(result, [&](const AovCandidate& c) { return rankOf(c, role) == best; });
    keepIf(result, [&](const AovCandidate& c) { return !hasNoisyTwin(all, c); });
  } else {
    keepIf(result, [&](const AovCandidate& c) {
      return isColor(role) && !c.selection.isGrey() && !servesAnotherRole(c) && !isPartOfColour(c, role);
    });
  }
  return result;
}

void preferBySize(Candidates& candidates, AovRole role) {
  const auto smaller = [](const AovCandidate& a, const AovCandidate& b) { return a.pixelCount < b.pixelCount; };
  const auto [smallest, largest] = std::minmax_element(candidates.begin(), candidates.end(), smaller);
  if (smallest != candidates.end()) {
    const int64_t wanted = role == AovRole::kColor ? smallest->pixelCount : largest->pixelCount;
    keepIf(candidates, [&](const AovCandidate& c) { return c.pixelCount == wanted; });
  }
}

// Whether a layer has channels such as ch00, ch01, as Mitsuba names those of an array.
bool hasNumberedChannels(const ExrFile& file) {
  const auto isNumbered = [](const ExrChannel& channel) {
    return channel.suffix.size() > 2 && channel.suffix.starts_with("ch") &&
           std::all_of(channel.suffix.begin() + 2, channel.suffix.end(), [](char c) { return c >= '0' && c <= '9'; });
  };
  return std::any_of(file.parts.begin(), file.parts.end(), [&](const ExrPart& part) {
    return std::any_of(part.layers.begin(), part.layers.end(), [&](const ExrLayer& layer) {
      return std::all_of(layer.channels.begin(), layer.channels.end(), isNumbered);
    });
  });
}

// A guide that is asked for of a file of one image.
bool isOneOfSeveralFiles(const ExrFile& file, AovRole role) {
  return !isColor(role) && file.parts.size() == 1 && file.parts[0].layers.size() == 1;
}

// What to do where no layer, or not one alone, fits: naming one helps only where there is one that could serve.
std::string remedyFor(const ExrFile& file, AovRole role, const std::string& option) {
  if (aovCandidates(file, role).empty() && hasNumberedChannels(file))
    return "; channels without names, as of an array that Mitsuba's write_bitmap() wrote, tell nothing: write "
           "film().bitmap(), which has them; " +
           describe(file);
  if (aovCandidates(file, role).empty()) return "; render it with this layer; " + describe(file);
  if (option.empty()) return "; take a file with one such layer; " + describe(file);
  return "; name the one to use with " + option + " LAYER" +
         (isOneOfSeveralFiles(file, role)
              ? ", or, where each image has a file of its own, as LuxCore writes them, join these (docs/renderers.md); "
              : "; ") +
         describe(file);
}

// What a layer must hold to serve.
std::string channelsOf(AovRole role) {
  if (role == AovRole::kDepth) return "one floating-point channel";
  if (role == AovRole::kNormal) return "floating-point channels X, Y, Z or R, G, B";
  return "floating-point channels R, G, B";
}

bool isDeep(const ExrFile& file, AovRole role) {
  return aovCandidates(file, role).empty() &&
         std::any_of(file.parts.begin(), file.parts.end(), [](const ExrPart& part) { return part.deep; });
}

// The layer of luminance and chroma that was meant, if there is one where no colour is found.
const ExrLayer* chromaLayer(const ExrFile& file, AovRole role) {
  if (!isColor(role) || !aovCandidates(file, role).empty()) return nullptr;
  for (const ExrPart& part : file.parts) {
    const auto found = std::find_if(part.layers.begin(), part.layers.end(), hasChroma);
    if (!part.deep && found != part.layers.end()) return &*found;
  }
  return nullptr;
}

const AovCandidate& single(const ExrFile& file, AovRole role, const std::string& name, const Candidates& found,
                           const std::string& option) {
  const std::string remedy = remedyFor(file, role, option);
  if (found.empty() && isDeep(file, role)) {
    throw Error("No " + toString(role) + " in '" + file.path.string() +
                "': expected a flat image, found deep samples; flatten it first.");
  }
  if (const ExrLayer* layer = found.empty() ? chromaLayer(file, role) : nullptr) {
    throw Error("No " + toString(role) + " in '" + file.path.string() + "': expected " + channelsOf(role) +
                ", found luminance and chroma, Y with RY and BY" +
                (layer->name.empty() ? "" : ", in layer '" + printable(layer->name) + "'") + "; save it as RGB.");
  }
  if (found.empty()) {
    throw Error("No " + toString(role) + " in '" + file.path.string() + "': expected " +
                (name.empty() ? "a layer of a known name" : "a layer '" + name + "'") + " with " + channelsOf(role) +
                ", found none" + remedy + ".");
  }
  if (found.size() > 1) {
    throw Error("The " + toString(role) + " in '" + file.path.string() + "' is ambiguous: expected one layer, found " +
                placesOf(found) + remedy + ".");
  }
  return found.front();
}

// The best names of one view.
Candidates bestOfView(Candidates candidates, AovRole role, const std::string& view) {
  keepIf(candidates, [&](const AovCandidate& c) { return c.view == view; });
  return bestByName(candidates, role);
}

AovCandidate choose(const ExrFile& file, AovRole role, Candidates candidates, const std::string& name,
                    const AovPlace& beside, const std::string& option) {
  if (name.empty()) {
    Candidates best = bestOfView(candidates, role, beside.view);
    candidates = best.empty() ? bestOfView(candidates, role, "") : std::move(best);
  } else {
    candidates = namedBy(file, candidates, name);
    for (const std::string& view : {beside.view, std::string()})
      preferIf(candidates, [&](const AovCandidate& c) { return c.view == view; });
  }
  preferBySize(candidates, role);
  if (beside.viewLayer) preferIf(candidates, [&](const AovCandidate& c) { return c.prefix == *beside.viewLayer; });
  return single(file, role, name, candidates, option);
}

// Cycles stores alpha with every colour pass; should the noisy one lack it, the finished one of its view layer has it.
std::optional<ExrSelection> alphaFor(const ExrFile& file, const AovCandidate& color) {
  if (color.alpha || !isNoisyRender(color)) {
    return color.alpha;
  }
  for (const AovCandidate& other : aovCandidates(file, AovRole::kColor)) {
    if (namesFinishedRender(other.stem) && other.prefix == color.prefix &&
        other.selection.part == color.selection.part && other.view == color.view) {
      return other.alpha;
    }
  }
  return std::nullopt;
}

void noteChoice(Aovs& result, const ExrFile& file, const AovCandidate& color, const std::string& request) {
  if (!request.empty()) {
    return;
  }
  const Candidates all = aovCandidates(file, AovRole::kColor);
  if (isNoisyRender(color) && std::any_of(all.begin(), all.end(), [&](const AovCandidate& c) {
        return namesFinishedRender(c.stem) && c.prefix == color.prefix;
      })) {
    result.notes.push_back("The colour is '" + printable(color.selection.layer) +
                           "', the render before denoising; '--color Combined' takes the denoised one.");
  }
  if (!rankOf(color, AovRole::kColor)) {
    result.notes.push_back("The colour is '" + printable(color.selection.layer) +
                           "', the only layer that is neither albedo nor normal.");
  }
  const auto isOther = [](const AovCandidate& c) { return !c.view.empty(); };
  const auto isSameOfOther = [&](const AovCandidate& c) {
    return isOther(c) && c.prefix == color.prefix && c.stem == color.stem;
  };
  auto other = std::find_if(all.begin(), all.end(), isSameOfOther);
  if (other == all.end()) other = std::find_if(all.begin(), all.end(), isOther);
  if (other != all.end())
    result.notes.push_back("Only the default view of '" + file.path.string() + "' is used; '--color " +
                           printable(isUnnamed(*other) ? other->view : other->selection.layer) + "' takes another.");
}

}  // namespace

std::string optionName(AovRole role) {
  if (role == AovRole::kFullColor) return "--aux-colour";
  if (role == AovRole::kColor) return "--color";
  const std::string words = toString(role);
  return "--" + words.substr(0, words.find(' '));
}

std::string AovRequest::nameOf(AovRole role) const {
  const auto found = names.find(role);
  return found == names.end() ? std::string() : found->second;
}

Aovs findAovs(const ExrFile& colorFile, const ExrFile& auxFile, const AovRequest& request) {
  const AovCandidate color = choose(colorFile, AovRole::kColor, aovCandidates(colorFile, AovRole::kColor),
                                    request.nameOf(AovRole::kColor), {}, optionName(AovRole::kColor));
  Aovs result;
  result.color = color.selection;
  result.place = {color.prefix, color.view};
  result.alpha = alphaFor(colorFile, color);
  for (const AovRole role : request.needed) {
    result.auxiliary[role] = findAov(auxFile, role, request.nameOf(role), result.place);
  }
  noteChoice(result, colorFile, color, request.nameOf(AovRole::kColor));
  return result;
}

bool hasAov(const ExrFile& file, AovRole role) {
  Candidates candidates = aovCandidates(file, role);
  keepIf(candidates, [](const AovCandidate& c) { return c.view.empty(); });
  return !bestByName(candidates, role).empty();
}

std::optional<ExrSelection> indirectLight(const ExrFile& file, AovRole role, const ExrSelection& direct) {
  for (const AovCandidate& candidate : aovCandidates(file, role)) {
    if (candidate.selection.part != direct.part || candidate.selection.layer != direct.layer) continue;
    const std::optional<std::string> wanted = indirectLightName(role, candidate.stem);
    if (!wanted) return std::nullopt;
    for (const AovCandidate& other : aovCandidates(file, role))
      if (plainName(other.stem) == plainName(*wanted) && other.prefix == candidate.prefix &&
          other.view == candidate.view && other.pixelCount == candidate.pixelCount)
        return other.selection;
    throw Error("No indirect " + toString(role) + " in '" + file.path.string() + "': expected '" + *wanted +
                "' beside '" + printable(direct.layer) + "'; render it with both passes.");
  }
  return std::nullopt;
}

ExrSelection findAov(const ExrFile& file, AovRole role, const std::string& name) {
  return findAov(file, role, name, optionName(role));
}

ExrSelection findAov(const ExrFile& file, AovRole role, const std::string& name, const std::string& option) {
  return choose(file, role, aovCandidates(file, role), name, {}, option).selection;
}

ExrSelection findAov(const ExrFile& file, AovRole role, const std::string& name, const AovPlace& beside) {
  return choose(file, role, aovCandidates(file, role), name, beside, optionName(role)).selection;
}

ExrSelection findColourOrNormal(const ExrFile& file, const std::string& name, const std::string& option) {
  Candidates candidates = aovCandidates(file, AovRole::kColor);
  const Candidates normals = name.empty() ? Candidates{} : aovCandidates(file, AovRole::kNormal);
  for (const AovCandidate& normal : normals)
    if (std::none_of(candidates.begin(), candidates.end(), [&](const AovCandidate& c) {
          return c.selection.part == normal.selection.part && c.selection.layer == normal.selection.layer;
        }))
      candidates.push_back(normal);
  return choose(file, AovRole::kColor, std::move(candidates), name, {}, option).selection;
}

}  // namespace xrds
