#include "viewer/tracer/packed_scene.h"

#include <gtest/gtest.h>

#include <bit>
#include <numeric>
#include <random>

#include "viewer/tracer/bvh.h"
#include "viewer/tracer/lights.h"
#include "xrds/error.h"

namespace xrds {
namespace {

Vec3 xyz(const Texel& texel) { return {texel[0], texel[1], texel[2]}; }

struct Ray {
  Vec3 origin, direction;
};

// The distance at which the ray meets triangle i, or `limit`; in the arithmetic of the shader.
float distanceTo(const PackedScene& scene, const Ray& ray, size_t i, float limit) {
  const Vec3 corner = xyz(scene.triangles[3 * i]), edge1 = xyz(scene.triangles[3 * i + 1]);
  const Vec3 edge2 = xyz(scene.triangles[3 * i + 2]), across = cross(ray.direction, edge2), from = ray.origin - corner;
  const float scale = 1 / dot(edge1, across);
  const Vec3 other = cross(from, edge1);
  const float u = dot(from, across) * scale, v = dot(ray.direction, other) * scale,
              distance = dot(edge2, other) * scale;
  return u >= 0 && v >= 0 && u + v <= 1 && distance > 0 && distance < limit ? distance : limit;
}

struct Walk {
  float distance = 1e30F;
  size_t steps = 0;
};

// The walk of trace_geometry.glsl.
Walk walk(const PackedScene& scene, const Ray& ray) {
  const trace::TraceParams& p = scene.params;
  const Vec3 origin{p.gridX, p.gridY, p.gridZ}, step{p.gridStepX, p.gridStepY, p.gridStepZ};
  int octant = 0;
  for (int axis = 0; axis < 3; ++axis) octant |= ray.direction[axis] < 0 ? 1 << axis : 0;
  Walk found;
  for (int node = 0; node < p.nodeCount; ++found.steps) {
    const Texel& box = scene.nodes[static_cast<size_t>(octant * p.nodeCount + node)];
    float enter = 0, leave = found.distance;
    for (int axis = 0; axis < 3; ++axis) {
      const auto word = std::bit_cast<uint32_t>(box[static_cast<size_t>(axis)]);
      const float inverse = 1 / ray.direction[axis];
      const float a = (origin[axis] + step[axis] * static_cast<float>(word & 0xFFFF) - ray.origin[axis]) * inverse;
      const float b = (origin[axis] + step[axis] * static_cast<float>(word >> 16) - ray.origin[axis]) * inverse;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    const auto link = static_cast<int>(box[3]);
    node = enter <= leave || link < 0 ? node + 1 : link;
    if (enter > leave || link >= 0) continue;
    for (int i = (-link - 1) / 4; i <= (-link - 1) / 4 + (-link - 1) % 4; ++i)
      found.distance = distanceTo(scene, ray, static_cast<size_t>(i), found.distance);
  }
  return found;
}

float bruteForce(const PackedScene& scene, const Ray& ray) {
  float distance = 1e30F;
  for (int i = 0; i < scene.params.triangleCount; ++i)
    distance = distanceTo(scene, ray, static_cast<size_t>(i), distance);
  return distance;
}

struct Random {
  std::mt19937 bits{7};
  float number() { return static_cast<float>(bits() >> 8) * 0x1p-23F - 1; }
  Vec3 vec() { return {number(), number(), number()}; }
};

TraceScene randomTriangles(size_t count, float size) {
  TraceScene scene{.materials = {{}}};
  Random random;
  for (size_t i = 0; i < count; ++i) {
    const Vec3 corner = 5 * random.vec();
    scene.triangles.push_back({{corner, corner + size * random.vec(), corner + size * random.vec()}, {}});
  }
  return scene;
}

TEST(TracerScene, HierarchyFindsTheHitsOfBruteForce) {
  for (const auto& [count, size] : {std::pair<size_t, float>{1, 3}, {2, 3}, {300, 1}, {3000, 0.3F}}) {
    const PackedScene scene = packScene(randomTriangles(count, size));
    Random random;
    size_t hits = 0, steps = 0;
    for (int i = 0; i < 1000; ++i) {
      const Ray ray{6 * random.vec(), normalized(random.vec())};
      const Walk found = walk(scene, ray);
      EXPECT_EQ(found.distance, bruteForce(scene, ray));
      hits += found.distance < 1e30F ? 1 : 0;
      steps += found.steps;
    }
    EXPECT_GT(hits, 0U);
    EXPECT_LT(steps, 1000U * 200) << "of " << scene.params.nodeCount << " nodes";
  }
}

TEST(TracerScene, BuiltInScenesAreWholeAndTheirHierarchiesRight) {
  for (const std::string& name : builtInSceneNames()) {
    const TraceScene made = builtInScene(name);
    EXPECT_EQ(made.name, name);
    for (const Triangle& triangle : made.triangles)
      for (const Vec3& normal : triangle.normals) ASSERT_NEAR(length(normal), 1, 1e-3) << name;
    const PackedScene scene = packScene(made);
    for (int i = 0; i < 15; ++i) {
      const Vec3 aside{0.1F * static_cast<float>(i % 4 - 2), 0.1F * static_cast<float>(i / 4 - 2), 0};
      const Ray ray{made.camera.position, normalized(made.camera.target - made.camera.position + aside)};
      EXPECT_EQ(walk(scene, ray).distance, bruteForce(scene, ray)) << name;
    }
  }
  EXPECT_THROW(builtInScene("attic"), Error);
}

TEST(TracerScene, BoxesAreFloatsThatNoDeviceFlushes) {
  for (const Texel& node : packScene(randomTriangles(300, 1)).nodes)
    for (const float word : node) EXPECT_TRUE(std::isnormal(word));
}

TEST(TracerScene, RefusesNoTriangles) { EXPECT_THROW(packScene({.materials = {{}}}), Error); }

TEST(TracerScene, TexturesAreHalvedUntilTheyFit) {
  TraceScene scene = randomTriangles(1, 1);
  scene.textures.push_back({4096, 2050, std::vector<Vec3>(4096 * 2050, {0.25F, 0.5F, 1})});
  scene.materials[0].texture = 0;
  const PackedScene packed = packScene(scene);
  EXPECT_EQ(packed.textures.size(), 2048U * 1025U);
  EXPECT_EQ(packed.textures.back(), (std::array<uint16_t, 4>{0x3400, 0x3800, 0x3C00, 0x3C00}));
  EXPECT_EQ(packed.materials[2][1], 2048);
}

// The table must give back the probabilities that it was made of.
TEST(TracerLights, AliasTableKeepsTheProbabilities) {
  const std::vector<float> weights{1, 0, 5, 0.25F, 3, 0, 0.75F};
  const auto table = aliasTable(weights);
  std::vector<double> found(weights.size());
  for (size_t i = 0; i < table.size(); ++i) {
    found[i] += table[i].threshold;
    found[table[i].alias] += 1.0 - table[i].threshold;
  }
  for (size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i] / 7, weights[i] / 10, 1e-6);
}

TEST(TracerLights, SkyDensityIsAProbability) {
  const Sky sky = makeSky(16, [](Vec3 d) { return d.y > 0.8F ? Vec3{50, 50, 50} : Vec3{0.1F, 0.2F, 0.3F}; });
  const auto texels = skyTexels(sky);
  const double cellArea = 4.0 / (16 * 16);
  double sum = 0;
  for (const SkyTexel& texel : texels) {
    EXPECT_GT(texel.density, 0);
    sum += texel.density * cellArea;
  }
  EXPECT_NEAR(sum, 1, 1e-4);
  EXPECT_NEAR(skyDirection(0.5F, 0.5F).y, 1, 1e-6);
  EXPECT_NEAR(skyDirection(0, 0).y, -1, 1e-6);
}

}  // namespace
}  // namespace xrds
