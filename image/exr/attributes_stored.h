#pragma once

#include <OpenEXR/ImfHeader.h>

#include <memory>
#include <string_view>

#include "image/exr/attributes.h"

namespace xrds {

/// The attributes as OpenEXR holds them: a header of which only the entries that `describesPicture` names count.
struct ExrAttributes::Stored {
  Imf::Header header;
};

/// Whether an attribute speaks of the picture, so that it may be passed on to another file, and not of the way one
/// file stores it (channels, compression, tiles, windows, part and view names, preview and the like) or of layers that
/// do not travel with it (Cryptomatte's tables, Blender's mark of a multi-layer file).
bool describesPicture(std::string_view attributeName);

/// Whether an attribute speaks of layers and goes where they are copied to: Cryptomatte's tables, and Blender's mark.
bool describesLayers(std::string_view attributeName);

/// The attributes of a header that was read from a file.
ExrAttributes attributesOf(const Imf::Header& header);

}  // namespace xrds
