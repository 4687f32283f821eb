#pragma once

#include <array>
#include <vector>

#include "viewer/tracer/scene.h"
#include "viewer/tracer/trace_parameters.h"

namespace xrds {

using Texel = std::array<float, 4>;

/// A scene in the layout that the kernels read (trace_parameters.h); no list is empty.
struct PackedScene {
  std::vector<Texel> nodes, triangles, materials, sky, lights;
  std::vector<std::array<uint16_t, 4>> textures;  // halves
  trace::TraceParams params{};                    // those fields that the scene decides
};

/// Builds the hierarchy and the light tables. Throws Error if the scene has no triangles or is too large.
PackedScene packScene(const TraceScene& scene);

}  // namespace xrds
