#pragma once

#include <span>
#include <vector>

#include "viewer/tracer/scene.h"

namespace xrds {

/// An entry of Walker's alias table: with probability `threshold` the entry itself is drawn, else `alias`.
struct AliasEntry {
  float threshold = 1;
  uint32_t alias = 0;
};

/// Draws i with a probability in proportion to weights[i]. All zero: every entry alike.
std::vector<AliasEntry> aliasTable(std::span<const float> weights);

/// A texel of the sky for the shader: radiance, and the probability density with which its cell is drawn, in relation
/// to the area of the octahedral map, which is 4.
struct SkyTexel {
  Vec3 radiance;
  float density = 0;
};

/// The density follows the mean of the interpolated luminance, so that a neighbour of the sun is drawn often enough.
std::vector<SkyTexel> skyTexels(const Sky& sky);

/// The mean radiance of the sky over all directions.
Vec3 meanRadiance(const Sky& sky);

}  // namespace xrds
