#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "image/exr/file.h"
#include "image/exr/read.h"
#include "image/layers/aov_names.h"

namespace xrds {

/// A layer that could serve a purpose because it has the channels for it, whatever its name: for a role three or, for
/// depth, one. Of a grey one the same channel stands for all three.
struct AovCandidate {
  ExrSelection selection;
  std::string prefix;        ///< What stands before the layer's own name: Cycles' view layer.
  std::string stem;          ///< The layer's own name, without view.
  std::string view;          ///< Empty for the default view.
  bool namedByPart = false;  ///< An unnamed layer, alone in one of several parts, goes by the name of its part.
  int64_t pixelCount = 0;
  std::optional<ExrSelection> alpha;
};

/// Takes the view off the end of a layer's name, as `layer.view` has it in files of several views; empty if it has
/// none.
std::string takeView(const ExrFile& file, std::string& layerName);

/// Whether a layer of that view is not of the default one; empty: it is of none.
bool isOtherView(const ExrFile& file, const std::string& view);

/// The channel Y of a layer of black and white, which has no other colour; null where it is none of that kind.
const ExrChannel* greyChannel(const ExrLayer& layer);

/// Whether a layer holds luminance and chroma, Y with RY and BY, of which the chroma is subsampled.
bool hasChroma(const ExrLayer& layer);

/// The layers of a file that have R, G, B (for normals and albedo also X, Y, Z; for colour and albedo also Y alone), in
/// upper or lower case and any order, as floating-point numbers, one a pixel; for depth those of a single channel, and
/// the channels Z and depth of the unnamed layer. Deep parts offer none.
std::vector<AovCandidate> aovCandidates(const ExrFile& file, AovRole role);

/// A layer of that part with these of its channels. `ownName`: its name, or a channel's that goes by its own.
AovCandidate candidateOf(const ExrFile& file, size_t part, const ExrLayer& layer, std::vector<std::string> channelNames,
                         const std::string& ownName);

void keepIf(std::vector<AovCandidate>& candidates, const std::function<bool(const AovCandidate&)>& wanted);

/// Drops what fails the test unless everything does.
void preferIf(std::vector<AovCandidate>& candidates, const std::function<bool(const AovCandidate&)>& wanted);

/// Whether it has no name, nor one of its view layer.
bool isUnnamed(const AovCandidate& candidate);

/// Those that a user's name means, by the strictest reading of it under which there are any: the layer's whole name,
/// that of its part, its own one, or its view's; PART: in front of it, the part's number, leaves those of that part.
std::vector<AovCandidate> namedBy(const ExrFile& file, std::vector<AovCandidate> candidates, std::string name);

/// Their parts and names, as "0:A.Vector, 0:B.Vector".
std::string placesOf(const std::vector<AovCandidate>& candidates);

}  // namespace xrds
