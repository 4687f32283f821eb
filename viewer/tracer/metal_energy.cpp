#include "viewer/tracer/metal_energy.h"

#include "viewer/tracer/trace_parameters.h"
#include "viewer/tracer/vec3.h"

namespace xrds {
namespace {

constexpr float kPi = 3.14159265F;

float shadowing(float cosine, float alpha) {
  const float square = std::max(cosine * cosine, 1e-8F);
  return 0.5F * (std::sqrt(1 + alpha * alpha * (1 - square) / square) - 1);
}

// The weight of one reflection about a facet drawn by visible normals (Heitz 2018).
float reflectionWeight(Vec3 outgoing, float alpha, float u, float v) {
  const Vec3 stretched = normalized({alpha * outgoing.x, alpha * outgoing.y, outgoing.z});
  const Vec3 t1 = normalized(Vec3{-stretched.y, stretched.x, 0} + Vec3{1e-9F, 0, 0}), t2 = cross(stretched, t1);
  const float radius = std::sqrt(u), s = 0.5F * (1 + stretched.z), x = radius * std::cos(2 * kPi * v);
  const float y = (1 - s) * std::sqrt(1 - x * x) + s * radius * std::sin(2 * kPi * v);
  const Vec3 n = x * t1 + y * t2 + std::sqrt(std::max(1 - x * x - y * y, 0.0F)) * stretched;
  const Vec3 facet = normalized({alpha * n.x, alpha * n.y, std::max(n.z, 1e-6F)});
  const Vec3 to = 2 * dot(outgoing, facet) * facet - outgoing;
  if (to.z <= 0) return 0;
  const float out = shadowing(outgoing.z, alpha);
  return (1 + out) / (1 + out + shadowing(to.z, alpha));
}

float directionalAlbedo(float cosine, float roughness) {
  constexpr int kSide = 24;
  const float c = std::max(cosine, 0.01F), alpha = std::max(roughness * roughness, 1e-3F);
  const Vec3 outgoing{std::sqrt(1 - c * c), 0, c};
  float sum = 0;
  for (int i = 0; i < kSide * kSide; ++i)
    sum += reflectionWeight(outgoing, alpha, (static_cast<float>(i / kSide) + 0.5F) / kSide,
                            (static_cast<float>(i % kSide) + 0.5F) / kSide);
  return sum / (kSide * kSide);
}

}  // namespace

std::vector<std::array<float, 4>> metalEnergyTable() {
  constexpr int kSize = trace::kEnergySize;
  std::vector<float> grid;
  for (int roughness = 0; roughness < kSize; ++roughness)
    for (int cosine = 0; cosine < kSize; ++cosine)
      grid.push_back(
          directionalAlbedo(static_cast<float>(cosine) / (kSize - 1), static_cast<float>(roughness) / (kSize - 1)));
  std::vector<std::array<float, 4>> table;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const int right = std::min(x + 1, kSize - 1), below = std::min(y + 1, kSize - 1);
      const auto at = [&](int column, int row) { return grid[static_cast<size_t>(row * kSize + column)]; };
      table.push_back({at(x, y), at(right, y), at(x, below), at(right, below)});
    }
  return table;
}

}  // namespace xrds
