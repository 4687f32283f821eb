#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "image/exr/file.h"
#include "image/image.h"

namespace xrds {

/// The channels of one part that are to be read together, in the order in which the image will hold them.
struct ExrSelection {
  size_t part = 0;
  std::string layer;                      ///< For messages: the name of the layer that the channels belong to.
  std::vector<std::string> channelNames;  ///< One may be there several times: that of a grey layer.

  /// Whether one channel stands for red, green and blue.
  bool isGrey() const { return channelNames.size() == 3 && channelNames[0] == channelNames[1]; }
  bool operator==(const ExrSelection&) const = default;
};

/// Reads the selected channels of a file over the whole data window of their part, half or float, scan lines or tiles,
/// as 32-bit floats without any conversion of their values. Throws Error when the part is deep, when a channel does not
/// exist, holds integers or is subsampled, and when the file is damaged or cut short. Safe to call from several
/// threads.
Image readLayer(const ExrFile& file, const ExrSelection& selection);

}  // namespace xrds
