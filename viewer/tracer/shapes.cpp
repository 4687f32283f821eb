#include "viewer/tracer/shapes.h"

namespace xrds {
namespace {

constexpr float kPi = 3.14159265F;

Vec3 turned(Vec3 v, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}

// A grid of vertices, each with position, normal and texture place, made into triangles.
struct Vertex {
  Vec3 position, normal;
  Vec2 uv;
};

void addTriangle(TraceScene& scene, const Vertex& a, const Vertex& b, const Vertex& c, uint32_t material) {
  if (length(cross(b.position - a.position, c.position - a.position)) <= 0) return;
  scene.triangles.push_back(
      {{a.position, b.position, c.position}, {a.normal, b.normal, c.normal}, {a.uv, b.uv, c.uv}, material});
}

void addGrid(TraceScene& scene, std::span<const Vertex> vertices, uint32_t columns, uint32_t material) {
  const auto rows = static_cast<uint32_t>(vertices.size() / columns);
  for (uint32_t y = 0; y + 1 < rows; ++y)
    for (uint32_t x = 0; x + 1 < columns; ++x) {
      const size_t i = size_t{y} * columns + x;
      addTriangle(scene, vertices[i], vertices[i + 1], vertices[i + columns + 1], material);
      addTriangle(scene, vertices[i], vertices[i + columns + 1], vertices[i + columns], material);
    }
}

}  // namespace

uint32_t addMaterial(TraceScene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

int addTexture(TraceScene& scene, Texture texture) {
  scene.textures.push_back(std::move(texture));
  return static_cast<int>(scene.textures.size() - 1);
}

void addQuad(TraceScene& scene, Vec3 corner, Vec3 edgeU, Vec3 edgeV, uint32_t material, Vec2 repeat) {
  const Vec3 normal = normalized(cross(edgeU, edgeV));
  const Vertex vertices[] = {{corner, normal, {0, repeat.y}},
                             {corner + edgeU, normal, {repeat.x, repeat.y}},
                             {corner + edgeV, normal, {0, 0}},
                             {corner + edgeU + edgeV, normal, {repeat.x, 0}}};
  addGrid(scene, vertices, 2, material);
}

void addBox(TraceScene& scene, Vec3 centre, Vec3 halfSize, float turn, uint32_t material, Vec2 repeat) {
  const Vec3 x = turned({halfSize.x, 0, 0}, turn), y{0, halfSize.y, 0}, z = turned({0, 0, halfSize.z}, turn);
  const auto face = [&](Vec3 out, Vec3 right, Vec3 up) {
    addQuad(scene, centre + out - right - up, 2 * right, 2 * up, material, repeat);
  };
  face(z, x, y);
  face(-1 * z, -1 * x, y);
  face(x, -1 * z, y);
  face(-1 * x, z, y);
  face(y, x, -1 * z);
  face(-1 * y, x, z);
}

void addSphere(TraceScene& scene, Vec3 centre, float radius, uint32_t material, uint32_t rings) {
  std::vector<Vertex> vertices;
  const uint32_t columns = 2 * rings + 1;
  for (uint32_t y = 0; y <= rings; ++y)
    for (uint32_t x = 0; x < columns; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(2 * rings);
      const float v = static_cast<float>(y) / static_cast<float>(rings);
      const float around = 2 * kPi * u, s = y == 0 || y == rings ? 0 : std::sin(kPi * v);
      const Vec3 normal{s * std::cos(around), std::cos(kPi * v), s * std::sin(around)};
      vertices.push_back({centre + radius * normal, normal, {u, v}});
    }
  addGrid(scene, vertices, columns, material);
}

void addTurned(TraceScene& scene, Vec3 base, std::span<const Vec2> profile, uint32_t material, uint32_t segments) {
  std::vector<Vertex> vertices;
  for (size_t i = 0; i < profile.size(); ++i) {
    const Vec2 before = profile[i > 0 ? i - 1 : 0], after = profile[std::min(i + 1, profile.size() - 1)];
    const Vec3 slope = normalized({after.y - before.y, before.x - after.x, 0});
    for (uint32_t x = 0; x <= segments; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(segments);
      const float c = std::cos(2 * kPi * u), s = std::sin(2 * kPi * u);
      vertices.push_back({base + Vec3{profile[i].x * c, profile[i].y, profile[i].x * s},
                          {slope.x * c, slope.y, slope.x * s},
                          {u, static_cast<float>(i) / static_cast<float>(profile.size() - 1)}});
    }
  }
  addGrid(scene, vertices, segments + 1, material);
}

void addInstance(TraceScene& scene, std::span<const Triangle> shape, const Transform& transform) {
  for (Triangle triangle : shape) {
    for (Vec3& position : triangle.positions)
      position = transform.position + transform.scale * turned(position, transform.turn);
    for (Vec3& normal : triangle.normals) normal = turned(normal, transform.turn);
    scene.triangles.push_back(triangle);
  }
}

}  // namespace xrds
