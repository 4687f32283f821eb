#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "image/image.h"

namespace xrds {

/// A layer that is the same everywhere tells nothing. Of albedo and normal the first that is so, `images` one for each
/// of `inputs`; empty if neither is.
std::string constantInput(const std::vector<std::string>& inputs, const std::vector<Image>& images);

/// Whether an input that is the same everywhere in the first frame of a sequence is left out of them all: where one is
/// so in the middle and the last frame, too. One that shows nothing, as before things come into view, does not speak
/// for the others. `hasConstant` says it of the frame of an index; where it throws Error or Failure, that is told when
/// its turn comes.
bool staysConstant(size_t frameCount, const std::function<bool(size_t)>& hasConstant);

/// The file of the model that does without such an input; empty if none is shipped for the scale.
std::filesystem::path modelWithout(const std::string& constantInput, int scale);

/// What is told of it.
std::string tellConstant(const std::string& constantInput, const std::string& model);

}  // namespace xrds
