#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "xrds/auxiliary_input.h"
#include "xrds/model.h"
#include "xrds/shipped_models.h"

namespace xrds {

/// The first file of this name in modelFolders(); empty if there is none.
std::filesystem::path inModelFolders(const std::string& fileName);

/// The file of a model given by name ("xrds-x4-compact") or by path. Throws Error that lists the models there are.
std::filesystem::path resolveModel(const std::string& nameOrFile);

/// Throws Error that names modelFolders() if none of them has a model.
void requireShippedModels();

/// "xrds-x<scale>-compact", whether it is shipped or not.
std::string defaultModelName(int scale);

/// "xrds-x4-mini", fast enough for live views, whether it is shipped or not. The samples of a view that rests are soon
/// so many that it makes the better picture than the model of few samples.
std::string liveModelName();

/// Whether the input is one of the model's.
bool takes(const Model& model, const AuxiliaryInput& input);

/// Throws Error unless a Frame can find every auxiliary input of this model: they are of kAuxiliaryInputs.
void requireKnownInputs(const Model& model, const std::string& modelName);

/// The file of the default model's variant for frames with these auxiliary images: of the colour alone, without
/// normals, with the full-resolution colour, or the default model itself. Empty if it is not shipped for the scale.
std::filesystem::path shippedVariant(int scale, const std::vector<std::string>& inputs);

/// The file of the model for frames with these auxiliary images, `scale` times the colour's size: the variant that
/// suits them, or the default model itself where that is not shipped. Albedo and normal with a colour of at most
/// kFewSamples samples a pixel, where that is known, take the model of few samples, if one is shipped. The colour alone
/// is upscaled by 4, whatever `scale` is. Throws Error as resolveModel does.
std::filesystem::path defaultModel(int scale, const std::vector<std::string>& inputs,
                                   std::optional<double> samples = {});

}  // namespace xrds
