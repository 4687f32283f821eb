#pragma once

#include <array>
#include <span>
#include <vector>

#include "viewer/tracer/scene.h"

namespace xrds {

/// The smallest box along the axes that holds what it includes; at first nothing.
struct Bounds {
  Vec3 lower{1e30F, 1e30F, 1e30F}, upper{-1e30F, -1e30F, -1e30F};
  void include(Vec3 point) { lower = minimum(lower, point), upper = maximum(upper, point); }
  void include(const Bounds& box) { lower = minimum(lower, box.lower), upper = maximum(upper, box.upper); }
  Vec3 centre() const { return 0.5F * (lower + upper); }
  float halfArea() const {
    const Vec3 size = maximum(upper - lower, {});
    return size.x * size.y + size.y * size.z + size.z * size.x;
  }
};

/// One node as the shader reads it, two texels. Nodes stand in the order in which a ray visits them, so that no stack
/// is needed: from a box that is hit the walk goes on to the next node, from one that is missed to `skip`.
struct BvhNode {
  Vec3 lower;
  float skip = 0;  // index of the first node behind this one's children
  Vec3 upper;
  float leaf = -1;  // first triangle * kMaxLeafTriangles + count - 1; negative for an inner node
};

/// A bounding volume hierarchy over the triangles of a scene.
struct Bvh {
  static constexpr uint32_t kMaxLeafTriangles = 4;
  static constexpr uint32_t kOctants = 8;

  Bounds bounds;
  std::vector<uint32_t> triangles;  // indices of the scene's triangles, in the order that the leaves count in
  uint32_t nodeCount = 0;
  /// The tree once for each octant of ray directions (bit 0: x negative, bit 1: y, bit 2: z), nearer children first:
  /// kOctants * nodeCount nodes; `skip` counts within an octant.
  std::vector<BvhNode> nodes;
};

/// Splits by the surface area heuristic. Throws Error if there are no triangles or more than 4 million.
Bvh buildBvh(std::span<const Triangle> triangles);

}  // namespace xrds
