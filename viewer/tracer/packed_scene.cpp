#include "viewer/tracer/packed_scene.h"

#include <half.h>

#include <algorithm>
#include <bit>

#include "viewer/tracer/bvh.h"
#include "viewer/tracer/lights.h"

namespace xrds {
namespace {

uint16_t halfBits(float value) { return Imath::half(value).bits(); }

Texel texel(Vec3 v, float w) { return {v.x, v.y, v.z, w}; }

float area(const Triangle& triangle) {
  const auto& [a, b, c] = triangle.positions;
  return 0.5F * length(cross(b - a, c - a));
}

// Of both bounds on an axis, each moved outwards by a step: more than what the shader's arithmetic loses.
float gridWord(float lower, float upper, float origin, float step) {
  const auto number = [&](float steps) {
    return static_cast<uint32_t>(
        std::clamp(steps, static_cast<float>(trace::kGridBegin), static_cast<float>(trace::kGridEnd)));
  };
  const uint32_t low = number(std::floor((lower - origin) / step) - 1);
  const uint32_t high = number(std::ceil((upper - origin) / step) + 1);
  return std::bit_cast<float>(low | high << 16);
}

void packNodes(const Bvh& bvh, PackedScene& packed) {
  const Vec3 extent = bvh.bounds.upper - bvh.bounds.lower;
  const float least = std::max(1e-6F * length(extent), 1e-12F);
  const Vec3 step = maximum(extent, {least, least, least}) * (1.0F / (trace::kGridEnd - trace::kGridBegin - 8));
  const Vec3 origin = bvh.bounds.lower - static_cast<float>(trace::kGridBegin + 4) * step;
  for (const BvhNode& node : bvh.nodes)
    packed.nodes.push_back(
        {gridWord(node.lower.x, node.upper.x, origin.x, step.x), gridWord(node.lower.y, node.upper.y, origin.y, step.y),
         gridWord(node.lower.z, node.upper.z, origin.z, step.z), node.leaf < 0 ? node.skip : -1 - node.leaf});
  trace::TraceParams& p = packed.params;
  p.gridX = origin.x, p.gridY = origin.y, p.gridZ = origin.z;
  p.gridStepX = step.x, p.gridStepY = step.y, p.gridStepZ = step.z;
}

void packTriangles(const TraceScene& scene, const Bvh& bvh, PackedScene& packed) {
  for (const uint32_t index : bvh.triangles) {
    const auto& [a, b, c] = scene.triangles[index].positions;
    packed.triangles.push_back(texel(a, 0));
    packed.triangles.push_back(texel(b - a, 0));
    packed.triangles.push_back(texel(c - a, 0));
  }
  for (const uint32_t index : bvh.triangles) {
    const Triangle& triangle = scene.triangles[index];
    for (size_t i = 0; i < 3; ++i) packed.triangles.push_back(texel(triangle.normals[i], triangle.uvs[i].x));
    packed.triangles.push_back(
        {triangle.uvs[0].y, triangle.uvs[1].y, triangle.uvs[2].y, static_cast<float>(triangle.material)});
  }
}

// The mean of each 2 x 2 pixels.
Texture halved(const Texture& texture) {
  Texture half{std::max(texture.width / 2, 1U), std::max(texture.height / 2, 1U)};
  for (uint32_t y = 0; y < half.height; ++y)
    for (uint32_t x = 0; x < half.width; ++x) {
      Vec3 sum;
      for (uint32_t i = 0; i < 4; ++i)
        sum = sum + texture.pixels[size_t{std::min(2 * y + i / 2, texture.height - 1)} * texture.width +
                                   std::min(2 * x + i % 2, texture.width - 1)];
      half.pixels.push_back(0.25F * sum);
    }
  return half;
}

// Appends the textures and returns for each the place that a material names: first texel, width, height.
std::vector<Vec3> packTextures(std::vector<Texture> textures, PackedScene& packed) {
  constexpr uint64_t kMostTexels = uint64_t{1} << 23;  // whole numbers that a float holds, 64 MiB
  const auto total = [&textures] {
    uint64_t sum = 0;
    for (const Texture& texture : textures) sum += texture.pixels.size();
    return sum;
  };
  while (total() > kMostTexels)
    for (Texture& texture : textures) texture = halved(texture);
  std::vector<Vec3> places;
  for (const Texture& texture : textures) {
    places.push_back({static_cast<float>(packed.textures.size()), static_cast<float>(texture.width),
                      static_cast<float>(texture.height)});
    for (const Vec3& rgb : texture.pixels)
      packed.textures.push_back({halfBits(rgb.x), halfBits(rgb.y), halfBits(rgb.z), halfBits(1)});
  }
  if (packed.textures.empty()) packed.textures.push_back({});
  return places;
}

void packMaterials(const TraceScene& scene, const std::vector<Vec3>& textures, PackedScene& packed) {
  for (const Material& material : scene.materials) {
    const Vec3 place = material.texture < 0 ? Vec3{-1, 0, 0} : textures.at(static_cast<size_t>(material.texture));
    packed.materials.push_back(texel(material.colour, static_cast<float>(material.kind)));
    packed.materials.push_back(texel(material.emission, material.roughness));
    packed.materials.push_back(texel(place, material.refraction));
  }
  if (packed.materials.empty()) packed.materials.resize(trace::kMaterialTexels);
}

void packSky(const Sky& sky, PackedScene& packed) {
  std::vector<float> weights;
  for (const SkyTexel& cell : skyTexels(sky)) {
    packed.sky.push_back(texel(cell.radiance, cell.density));
    weights.push_back(cell.density);
  }
  for (const AliasEntry& entry : aliasTable(weights))
    packed.lights.push_back({entry.threshold, static_cast<float>(entry.alias), 0, 0});
  packed.params.skySize = static_cast<int>(sky.size);
}

// Returns the sum over emitting triangles of area times luminance.
float packEmitters(const TraceScene& scene, const Bvh& bvh, PackedScene& packed) {
  std::vector<uint32_t> places;  // of emitting triangles, in the hierarchy's order
  std::vector<float> powers;
  float power = 0;
  for (uint32_t i = 0; i < bvh.triangles.size(); ++i) {
    const Triangle& triangle = scene.triangles[bvh.triangles[i]];
    const float own = luminance(scene.materials.at(triangle.material).emission) * area(triangle);
    if (own <= 0) continue;
    places.push_back(i);
    powers.push_back(own);
    power += own;
  }
  if (places.empty()) places.push_back(0), powers.push_back(1);
  const auto table = aliasTable(powers);
  for (size_t i = 0; i < places.size(); ++i)
    packed.lights.push_back({table[i].threshold, static_cast<float>(table[i].alias), static_cast<float>(places[i]),
                             static_cast<float>(scene.triangles[bvh.triangles[places[i]]].material)});
  packed.params.emitterCount = static_cast<int>(places.size());
  return power;
}

}  // namespace

PackedScene packScene(const TraceScene& scene) {
  const Bvh bvh = buildBvh(scene.triangles);
  PackedScene packed;
  packNodes(bvh, packed);
  packTriangles(scene, bvh, packed);
  packMaterials(scene, packTextures(scene.textures, packed), packed);
  const Sky dark{1, {{0, 0, 0}}};
  packSky(scene.sky.size ? scene.sky : dark, packed);
  const float power = packEmitters(scene, bvh, packed);

  // Each kind of light is drawn half of the time if there are both.
  const bool hasSky = luminance(meanRadiance(scene.sky)) > 0;
  packed.params.skyShare = power <= 0 ? 1 : hasSky ? 0.5F : 0;
  packed.params.inversePower = power > 0 ? 1 / power : 0;
  packed.params.nodeCount = static_cast<int>(bvh.nodeCount);
  packed.params.triangleCount = static_cast<int>(bvh.triangles.size());
  packed.params.originOffset = 1e-6F * length(bvh.bounds.upper - bvh.bounds.lower);
  return packed;
}

}  // namespace xrds
