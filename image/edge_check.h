#pragma once

#include <string>
#include <vector>

#include "image/aux_check.h"
#include "image/image.h"

namespace xrds {

/// Whether the auxiliary layers show edges where the colour does. `color` has the low resolution; each layer is a whole
/// multiple of its size, otherwise it is skipped. Returns a sentence when fewer than one in twenty of the strong edges
/// of the colour have an edge in any layer within one low-resolution pixel: the layers then belong to another frame or
/// camera, or are blank; so it is, rightly or not, with a frame whose only edges are shadows.
std::vector<std::string> checkEdges(const Image& color, const std::vector<NamedLayer>& layers);

}  // namespace xrds
