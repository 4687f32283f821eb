#pragma once

#include <string>
#include <vector>

#include "image/aux_check.h"
#include "image/image.h"

namespace xrds {

/// Whether a full-resolution colour shows the same part of the picture as the low-resolution one, of which it is a
/// whole multiple: the means of its pixels are compared with `low`, moved by at most one low-resolution pixel. Returns
/// a sentence where some step of whole pixels fits clearly better than none, as with renderers that put the origin into
/// the middle of a pixel.
std::vector<std::string> checkShift(const Image& low, const NamedLayer& full);

}  // namespace xrds
