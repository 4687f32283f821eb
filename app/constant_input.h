#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "image/image.h"

namespace xrds {

/// A layer that is the same everywhere tells nothing. Of albedo and normal the first that is so, `images` one for each
/// of `inputs`; empty if neither is.
std::string constantInput(const std::vector<std::string>& inputs, const std::vector<Image>& images);

/// The file of the model that does without such an input; empty if none is shipped for the scale.
std::filesystem::path modelWithout(const std::string& constantInput, int scale);

/// What is told of it.
std::string tellConstant(const std::string& constantInput, const std::string& model);

}  // namespace xrds
