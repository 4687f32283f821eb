#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "image/image.h"

namespace xrds {

/// What the values of one layer look like; non-finite values are counted and otherwise left out.
struct LayerStatistics {
  double minimum = 0.0;
  double maximum = 0.0;
  double mean = 0.0;
  size_t nonFiniteCount = 0;
  double zeroPixelShare = 0.0;  ///< The share of pixels, 0 to 1, whose channels are all 0.
};

/// The statistics of all values of a layer; of an empty image, zeros.
LayerStatistics statisticsOf(const Image& image);

/// The statistics as text, such as "minimum 0, maximum 0.97, mean 0.41, 12 % of the pixels black".
std::string toString(const LayerStatistics& statistics);

/// A layer to check and the name under which the user knows it.
struct NamedLayer {
  std::string name;
  const Image* image = nullptr;
};

/// What is suspicious about an albedo layer: nothing but zeros, one value everywhere, negative values, more than two
/// surfaces' pixels in a hundred above 1. Surfaces are where `normal`, of the albedo's size, has a length: Cycles
/// stores the radiance of background and sky as their albedo. Without normals every pixel counts. One sentence each,
/// with the layer's name and statistics.
std::vector<std::string> checkAlbedo(const NamedLayer& albedo, const Image* normal = nullptr);

/// What is suspicious about a normal layer: nothing but zeros, one value everywhere, values beyond [-1, 1], normals
/// stored as n / 2 + 1 / 2.
std::vector<std::string> checkNormal(const NamedLayer& normal);

/// What is suspicious about a layer of distances: nothing but zeros, one value everywhere.
std::vector<std::string> checkDepth(const NamedLayer& depth);

/// Whether a layer of three channels looks like unit normals stored as n / 2 + 1 / 2: no negative value, and 2 v - 1
/// has unit length for most of the pixels that are not black while v has not.
bool looksEncoded(const Image& normal);

}  // namespace xrds
