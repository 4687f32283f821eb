#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "viewer/tracer/vec3.h"

namespace xrds {

/// A pinhole camera; `up` need not be perpendicular to the view. The picture's width follows from its pixels.
struct Camera {
  Vec3 position{0, 0, 3}, target{}, up{0, 1, 0};
  float verticalFov = 0.7F;  // radians
  bool operator==(const Camera&) const = default;
};

enum class MaterialKind : uint8_t { diffuse, metal, glass };

/// How a surface scatters and emits light.
struct Material {
  MaterialKind kind = MaterialKind::diffuse;
  Vec3 colour{0.8F, 0.8F, 0.8F};  // diffuse albedo, reflection of a metal at normal incidence, tint of a glass surface
  float roughness = 0.5F;         // of a metal; its GGX alpha is the square
  float refraction = 1.5F;        // index of a glass
  Vec3 emission{};                // radiance, to both sides
  int texture = -1;               // in TraceScene::textures, multiplies the colour
};

/// Linear RGB, rows from the top (v = 0), repeated beyond [0, 1].
struct Texture {
  uint32_t width = 0, height = 0;
  std::vector<Vec3> pixels{};
};

struct Triangle {
  std::array<Vec3, 3> positions;
  std::array<Vec3, 3> normals;  // unit length, of the smooth surface
  std::array<Vec2, 3> uvs{};
  uint32_t material = 0;
};

/// Radiance from every direction: an octahedral map of size x size pixels with +y in its centre. Empty: no light.
struct Sky {
  uint32_t size = 0;
  std::vector<Vec3> radiance{};
};

/// What a path tracer renders; a plain value in metres, y up.
struct TraceScene {
  std::string name;
  std::vector<Triangle> triangles{};
  std::vector<Material> materials{};
  std::vector<Texture> textures{};
  Sky sky{};
  Camera camera{};  // to start with
};

/// A sky of size x size pixels, each the mean of `radianceOf(unit direction)` over a few directions in it.
Sky makeSky(uint32_t size, const std::function<Vec3(Vec3)>& radianceOf);

/// The direction at a point of the octahedral map, both coordinates in [0, 1].
Vec3 skyDirection(float u, float v);

/// The scenes made in code.
const std::vector<std::string>& builtInSceneNames();

/// Throws Error for a name that is not among them.
TraceScene builtInScene(const std::string& name);

/// Reads a glTF (.gltf, .glb) or Wavefront (.obj) file with its base-colour textures, under a plain sky if nothing in
/// it emits light, seen by its first camera or else from the front. Throws Error if the file cannot be read or is
/// empty.
TraceScene loadScene(const std::filesystem::path& file);

}  // namespace xrds
