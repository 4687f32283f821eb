#pragma once

#include <optional>
#include <string>

#include "image/exr/attributes.h"

namespace xrds {

/// What Cycles writes of the view layer that a layer belongs to: of "Front.Combined" and "samples" the text of
/// "cycles.Front.samples". Where the file names no such view layer, what it writes of all of them, if that is one text.
std::optional<std::string> cyclesText(const ExrAttributes& attributes, const std::string& layer,
                                      const std::string& what);

}  // namespace xrds
