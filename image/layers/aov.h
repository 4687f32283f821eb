#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "image/exr/file.h"
#include "image/exr/read.h"
#include "image/layers/aov_names.h"

namespace xrds {

/// Which layers the user named, and which are needed beside the colour. No name means: find it by convention. A name is
/// a layer's full name ("ViewLayer.Denoising Albedo"), the name of a part, a layer's own name ("albedo"), or any of
/// them after a part's number and a colon ("1:albedo"); "(unnamed)", "RGB" and "RGBA" also stand for the unnamed layer,
/// and the name of a view for that of this view.
struct AovRequest {
  std::map<AovRole, std::string> names{};
  std::vector<AovRole> needed{AovRole::kAlbedo, AovRole::kNormal};

  /// Empty if the user named none.
  std::string nameOf(AovRole role) const;
};

/// Where a colour stands among the layers of its file. What belongs to it is looked for there first.
struct AovPlace {
  std::optional<std::string> viewLayer{};  ///< What stands before its own name; nothing where that does not count.
  std::string view{};                      ///< Empty for the default view.
};

/// The option of the command line that names the layer of a role.
std::string optionName(AovRole role);

/// The layers to read: colour and alpha from the colour file, the others from the auxiliary file.
struct Aovs {
  ExrSelection color;
  std::optional<ExrSelection> alpha;          ///< One channel beside the colour, where there is one.
  std::map<AovRole, ExrSelection> auxiliary;  ///< Those that were needed; depth has one channel.
  AovPlace place;                             ///< That of the colour.
  std::vector<std::string> notes;             ///< Choices a user may want to know of, one sentence each.
};

/// Finds colour in `colorFile`, the layers that are needed beside it in `auxFile`, which may be the same file with
/// parts of different sizes. Where names are equally good, colour comes from the smallest part and the others from the
/// largest, and from the view layer of the colour. Cycles' "Noisy Image" goes before "Combined", which is denoised when
/// both are there. Views other than the default one are left alone, unless the colour that the user named is of one:
/// then the others come from that view, or from the default one where it lacks them. Throws Error, listing what the
/// file holds, when a needed layer is absent or several fit equally well.
Aovs findAovs(const ExrFile& colorFile, const ExrFile& auxFile, const AovRequest& request = {});

/// Whether the file holds a layer that goes by one of the role's known names.
bool hasAov(const ExrFile& file, AovRole role);

/// The layer of indirect light that belongs to one of direct light (indirectLightName()), beside it in the file;
/// nothing where the layer has no name of direct light. Throws Error if it should be there and is not.
std::optional<ExrSelection> indirectLight(const ExrFile& file, AovRole role, const ExrSelection& direct);

/// Finds one layer in one file, by convention or, when `name` is not empty, by that name. Throws as findAovs does.
ExrSelection findAov(const ExrFile& file, AovRole role, const std::string& name = "");

/// The same for a layer that belongs to a colour there: of its view layer and of its view.
ExrSelection findAov(const ExrFile& file, AovRole role, const std::string& name, const AovPlace& beside);

/// The same; its messages advise to name the layer with that option, or not at all where it is empty.
ExrSelection findAov(const ExrFile& file, AovRole role, const std::string& name, const std::string& option);

/// The colour or, when `name` is not empty, the layer of that name, which may have a normal's channels X, Y, Z, too.
/// Throws as findAov does, as of a colour.
ExrSelection findColourOrNormal(const ExrFile& file, const std::string& name, const std::string& option);

}  // namespace xrds
