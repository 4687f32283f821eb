#pragma once

#include <functional>

#include "viewer/tracer/scene.h"

namespace xrds {

/// A square texture, colourAt(u, v) at the centre of each pixel.
Texture paint(uint32_t size, const std::function<Vec3(float, float)>& colourAt);

/// Smooth noise in [0, 1] that repeats after `period` cells in both directions; several octaves of it.
float noise(float u, float v, int period, int octaves = 4);

/// A number in [0, 1) for a pair of whole numbers, the same everywhere.
float scramble(int x, int y);

/// Squares of two colours, `cells` each way (an even number).
Texture checker(uint32_t cells, Vec3 first, Vec3 second);

/// Planks along v with grain.
Texture planks(uint32_t count, Vec3 dark, Vec3 light);

/// Rows of bricks with joints.
Texture bricks(uint32_t rows, Vec3 brick, Vec3 joint);

/// Lines of what looks like small print.
Texture print(uint32_t lines, Vec3 paper, Vec3 ink);

/// Two colours mixed by noise.
Texture mottled(int period, Vec3 first, Vec3 second);

}  // namespace xrds
