#include "viewer/tracer/lights.h"

#include <algorithm>
#include <numeric>

namespace xrds {
namespace {

// The solid angle that a unit of the map's area stands for, where |p| is the distance to the octahedron.
float solidAngleDensity(float u, float v) {
  const float x = std::abs(2 * u - 1), z = std::abs(2 * v - 1), y = 1 - x - z;
  const Vec3 onOctahedron = y >= 0 ? Vec3{x, y, z} : Vec3{1 - z, -y, 1 - x};
  const float distance = length(onOctahedron);
  return 1 / (distance * distance * distance);
}

float cellCentre(uint32_t cell, uint32_t size) { return (static_cast<float>(cell) + 0.5F) / static_cast<float>(size); }

}  // namespace

Vec3 skyDirection(float u, float v) {
  float x = 2 * u - 1, z = 2 * v - 1;
  const float y = 1 - std::abs(x) - std::abs(z), folded = std::max(-y, 0.0F);
  x += x >= 0 ? -folded : folded;
  z += z >= 0 ? -folded : folded;
  return normalized({x, y, z});
}

Sky makeSky(uint32_t size, const std::function<Vec3(Vec3)>& radianceOf) {
  constexpr uint32_t kSide = 2;  // directions a cell and axis
  Sky sky{.size = size};
  for (uint32_t cellY = 0; cellY < size; ++cellY)
    for (uint32_t cellX = 0; cellX < size; ++cellX) {
      Vec3 sum;
      for (uint32_t i = 0; i < kSide * kSide; ++i)
        sum = sum + radianceOf(skyDirection(cellCentre(cellX * kSide + i % kSide, size * kSide),
                                            cellCentre(cellY * kSide + i / kSide, size * kSide)));
      sky.radiance.push_back(sum * (1.0F / (kSide * kSide)));
    }
  return sky;
}

std::vector<AliasEntry> aliasTable(std::span<const float> weights) {
  const size_t count = weights.size();
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<AliasEntry> table(count);
  std::vector<double> share(count, 1.0);
  std::vector<uint32_t> small, large;
  for (uint32_t i = 0; i < count; ++i) {
    if (sum > 0) share[i] = weights[i] / sum * static_cast<double>(count);
    table[i].alias = i;
    (share[i] < 1 ? small : large).push_back(i);
  }
  while (!small.empty() && !large.empty()) {
    const uint32_t poor = small.back(), rich = large.back();
    small.pop_back();
    table[poor] = {static_cast<float>(share[poor]), rich};
    share[rich] -= 1 - share[poor];
    if (share[rich] >= 1) continue;
    large.pop_back();
    small.push_back(rich);
  }
  return table;  // what is left has a share of 1 but for rounding
}

std::vector<SkyTexel> skyTexels(const Sky& sky) {
  const auto size = static_cast<int>(sky.size);
  std::vector<SkyTexel> texels;
  double sum = 0;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      float mean = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int atX = std::clamp(x + dx, 0, size - 1), atY = std::clamp(y + dy, 0, size - 1);
          mean += luminance(sky.radiance[static_cast<size_t>(atY * size + atX)]) * (dx ? 0.125F : 0.75F) *
                  (dy ? 0.125F : 0.75F);
        }
      const float weight = mean * solidAngleDensity(cellCentre(static_cast<uint32_t>(x), sky.size),
                                                    cellCentre(static_cast<uint32_t>(y), sky.size));
      texels.push_back({sky.radiance[static_cast<size_t>(y * size + x)], weight});
      sum += weight;
    }
  const double cellArea = 4.0 / (double{static_cast<double>(size)} * size);
  for (SkyTexel& texel : texels) texel.density = sum > 0 ? static_cast<float>(texel.density / (sum * cellArea)) : 0.25F;
  return texels;
}

Vec3 meanRadiance(const Sky& sky) {
  Vec3 sum;
  float weights = 0;
  for (uint32_t i = 0; i < sky.radiance.size(); ++i) {
    const float weight = solidAngleDensity(cellCentre(i % sky.size, sky.size), cellCentre(i / sky.size, sky.size));
    sum = sum + sky.radiance[i] * weight;
    weights += weight;
  }
  return weights > 0 ? sum * (1 / weights) : Vec3{};
}

}  // namespace xrds
