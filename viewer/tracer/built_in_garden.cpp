#include <algorithm>

#include "viewer/tracer/built_in.h"
#include "viewer/tracer/patterns.h"
#include "viewer/tracer/shapes.h"

namespace xrds {
namespace {

constexpr float kPi = 3.14159265F;

Vec3 skyColour(Vec3 direction, Vec3 towardsSun, Vec3 zenith, Vec3 horizon, Vec3 sun) {
  const float high = std::max(direction.y, 0.0F), near = std::max(dot(direction, towardsSun), 0.0F);
  const float haze = std::exp(-5 * high),
              cloud = noise(direction.x / (high + 0.25F) * 0.1F + 0.5F, direction.z / (high + 0.25F) * 0.1F + 0.5F, 6);
  const Vec3 air =
      mix(mix(zenith, horizon, haze), {1.1F, 1.1F, 1.1F}, direction.y > 0 ? 0.9F * std::max(cloud - 0.45F, 0.0F) : 0);
  const Vec3 glow = sun * (0.004F * std::pow(near, 40.0F));
  if (direction.y < 0) return mix(horizon, {0.12F, 0.12F, 0.1F}, std::min(-6 * direction.y, 1.0F));
  return near > 0.9993F ? sun : air + glow;
}

// Blades as thin triangles that lean outwards.
std::vector<Triangle> makeTuft(uint32_t material, int blades) {
  std::vector<Triangle> tuft;
  for (int i = 0; i < blades; ++i) {
    const float angle = 2 * kPi * scramble(i, 11), lean = 0.15F + 0.35F * scramble(i, 12);
    const float high = 0.12F + 0.16F * scramble(i, 13), wide = 0.008F + 0.006F * scramble(i, 14);
    const Vec3 out{std::cos(angle), 0, std::sin(angle)}, side{-out.z * wide, 0, out.x * wide};
    const Vec3 foot = 0.07F * scramble(i, 15) * out, top = foot + lean * high * out + Vec3{0, high, 0};
    const Vec3 normal = normalized(cross(side, top - foot));
    tuft.push_back(
        {{foot - side, foot + side, top}, {normal, normal, normal}, {{{0, 1}, {1, 1}, {0.5F, 0}}}, material});
  }
  return tuft;
}

// A crown of leaves, each two triangles, on a trunk.
std::vector<Triangle> makeTree(uint32_t bark, uint32_t leaf, int leaves, int seed) {
  TraceScene scene;
  const Vec2 trunk[] = {{0.16F, 0}, {0.1F, 0.25F}, {0.08F, 1.1F}, {0.05F, 1.9F}, {0.01F, 2.6F}};
  addTurned(scene, {}, trunk, bark, 10);
  for (int i = 0; i < leaves; ++i) {
    const float around = 2 * kPi * scramble(i, seed), up = 2 * scramble(i, seed + 1) - 1;
    const float radius = std::cbrt(scramble(i, seed + 2)), flat = std::sqrt(1 - up * up);
    const float lump = 0.75F + 0.35F * noise(around / (2 * kPi), 0.5F * up + 0.5F, 5, 2);
    const Vec3 out{flat * std::cos(around), up, flat * std::sin(around)};
    const Vec3 centre = Vec3{0, 2.1F, 0} + lump * radius * (out * Vec3{1.05F, 1.0F, 1.05F});
    const Vec3 x = normalized(cross(out, {scramble(i, seed + 3) - 0.5F, 0.7F, scramble(i, seed + 4) - 0.5F}));
    const Vec3 y = normalized(cross(x, out + Vec3{0, 0.8F * scramble(i, seed + 5), 0}));
    addQuad(scene, centre, 0.13F * x, 0.085F * y, leaf);
  }
  return scene.triangles;
}

std::vector<Triangle> makeStone(uint32_t material, int seed) {
  TraceScene scene;
  addSphere(scene, {}, 1, material, 12);
  for (Triangle& triangle : scene.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const Vec3 n = triangle.positions[i];
      const float rough =
          0.7F + 0.5F * noise(0.25F * n.x + 0.3F * n.z + 0.1F * static_cast<float>(seed), 0.25F * n.y, 8, 3);
      triangle.positions[i] = rough * n * Vec3{1, 0.65F, 0.85F};
    }
  for (Triangle& triangle : scene.triangles) {
    const auto& [a, b, c] = triangle.positions;
    const Vec3 face = cross(b - a, c - a);
    if (length(face) <= 0) continue;
    const Vec3 normal = dot(face, a) < 0 ? normalized(-1 * face) : normalized(face);
    triangle.normals = {normal, normal, normal};
  }
  return scene.triangles;
}

// The middle of the path across the meadow at that depth.
float pathAt(float z) { return 0.9F * std::sin(0.45F * z) + 0.25F; }

float groundAt(float x, float z) {
  const float far = std::min(std::abs(x - pathAt(z)) / 1.2F, 1.0F);
  return far * 0.35F * (noise(x / 24 + 0.5F, z / 24 + 0.5F, 6, 2) - 0.5F);
}

void addGround(TraceScene& scene) {
  const int grass = addTexture(scene, mottled(48, {0.1F, 0.17F, 0.035F}, {0.3F, 0.34F, 0.1F}));
  const int gravel = addTexture(
      scene, paint(512, [](float u, float v) {
        return mix({0.3F, 0.25F, 0.19F}, {0.66F, 0.6F, 0.5F}, std::clamp(3 * noise(u, v, 64, 2) - 1, 0.0F, 1.0F));
      }));
  const uint32_t materials[] = {addMaterial(scene, {.colour = {1, 1, 1}, .texture = grass}),
                                addMaterial(scene, {.colour = {1, 1, 1}, .texture = gravel})};
  constexpr int kCells = 96;
  constexpr float kSpan = 24;
  const auto corner = [](int x, int z) {
    const float pz = kSpan * (static_cast<float>(z) / kCells - 0.5F);
    const float px = kSpan * (static_cast<float>(x) / kCells - 0.5F) + pathAt(pz);  // so that edges follow the path
    return Vec3{px, groundAt(px, pz), pz};
  };
  for (int z = 0; z < kCells; ++z)
    for (int x = 0; x < kCells; ++x) {
      const Vec3 a = corner(x, z), b = corner(x + 1, z), c = corner(x + 1, z + 1), d = corner(x, z + 1);
      const bool isPath = std::abs(x - kCells / 2 + 0.5F) < 2.1F;
      const auto add = [&](Vec3 p, Vec3 q, Vec3 r) {
        const Vec3 normal = normalized(cross(q - p, r - p));
        const auto place = [](Vec3 v) { return Vec2{v.x / 3, v.z / 3}; };
        scene.triangles.push_back(
            {{p, q, r}, {normal, normal, normal}, {place(p), place(q), place(r)}, materials[isPath ? 1 : 0]});
      };
      add(a, c, b);
      add(a, d, c);
    }
}

void scatterPlants(TraceScene& scene) {
  const uint32_t blade = addMaterial(scene, {.colour = {0.2F, 0.33F, 0.07F}});
  const uint32_t dry = addMaterial(scene, {.colour = {0.42F, 0.38F, 0.14F}});
  const uint32_t rock = addMaterial(
      scene,
      {.colour = {1, 1, 1}, .texture = addTexture(scene, mottled(12, {0.2F, 0.19F, 0.18F}, {0.55F, 0.53F, 0.5F}))});
  const std::vector<Triangle> tufts[] = {makeTuft(blade, 26), makeTuft(dry, 18)};
  const std::vector<Triangle> stones[] = {makeStone(rock, 1), makeStone(rock, 5)};
  for (int i = 0; i < 2600; ++i) {
    const float x = 16 * (scramble(i, 21) - 0.5F), z = 8 - 18 * scramble(i, 22);
    if (std::abs(x - pathAt(z)) < 0.6F) continue;
    addInstance(scene, tufts[scramble(i, 23) < 0.8F ? 0 : 1],
                {{x, groundAt(x, z) - 0.01F, z}, 0.7F + 0.7F * scramble(i, 24), 2 * kPi * scramble(i, 25)});
  }
  for (int i = 0; i < 70; ++i) {
    const float z = 7 - 16 * scramble(i, 31), side = scramble(i, 32) < 0.5F ? -1.0F : 1.0F;
    const float x = pathAt(z) + side * (0.6F + 0.35F * scramble(i, 33)), size = 0.05F + 0.13F * scramble(i, 34);
    addInstance(scene, stones[i % 2], {{x, groundAt(x, z) + 0.3F * size, z}, size, 2 * kPi * scramble(i, 35)});
  }
}

void plantTrees(TraceScene& scene) {
  const uint32_t bark = addMaterial(
      scene,
      {.colour = {1, 1, 1}, .texture = addTexture(scene, bricks(24, {0.26F, 0.19F, 0.14F}, {0.1F, 0.07F, 0.05F}))});
  const Vec3 greens[] = {{0.13F, 0.3F, 0.06F}, {0.26F, 0.36F, 0.07F}, {0.55F, 0.28F, 0.06F}};
  std::vector<std::vector<Triangle>> trees;
  for (int i = 0; i < 3; ++i)
    trees.push_back(makeTree(bark, addMaterial(scene, {.colour = greens[i]}), 1100, 100 + 10 * i));
  for (int i = 0; i < 26; ++i) {
    const float z = 3.5F - 13 * scramble(i, 41), side = scramble(i, 42) < 0.5F ? -1.0F : 1.0F;
    const float x = pathAt(z) + side * (1.9F + 5.5F * scramble(i, 43));
    addInstance(scene, trees[static_cast<size_t>(i) % trees.size()],
                {{x, groundAt(x, z), z}, 0.7F + 0.55F * scramble(i, 44), 2 * kPi * scramble(i, 45)});
  }
}

// A brick hut with a metal roof at the end of the path.
void addHut(TraceScene& scene) {
  const uint32_t wall = addMaterial(
      scene,
      {.colour = {1, 1, 1}, .texture = addTexture(scene, bricks(20, {0.52F, 0.26F, 0.18F}, {0.6F, 0.57F, 0.52F}))});
  const uint32_t roof = addMaterial(scene, {MaterialKind::metal, {0.6F, 0.64F, 0.62F}, 0.45F});
  const uint32_t door = addMaterial(
      scene, {.colour = {1, 1, 1}, .texture = addTexture(scene, planks(4, {0.1F, 0.2F, 0.28F}, {0.2F, 0.36F, 0.45F}))});
  const Vec3 at{pathAt(-6.5F), 0, -6.5F};
  addBox(scene, at + Vec3{0, 0.9F, 0}, {1.3F, 0.9F, 0.9F}, 0, wall, {1.4F, 1});
  addQuad(scene, at + Vec3{-0.3F, 0, 0.91F}, {0.6F, 0, 0}, {0, 1.3F, 0}, door);
  const Vec3 left = at + Vec3{-1.5F, 1.75F, 1.1F}, along{0, 0, -2.2F}, ridge{1.5F, 0.75F, 0};
  addQuad(scene, left, ridge, along, roof);
  addQuad(scene, left + ridge, {1.5F, -0.75F, 0}, along, roof);
  for (const float z : {0.9F, -0.9F}) {
    TraceScene gable;
    addQuad(gable, at + Vec3{-1.3F, 1.8F, z}, {2.6F, 0, 0}, {1.3F, 0.7F, 0}, wall, {1.4F, 0.4F});
    scene.triangles.push_back(gable.triangles[0]);
    scene.triangles.back().positions[2] = at + Vec3{0, 2.5F, z};
  }
}

}  // namespace

TraceScene makeGarden() {
  TraceScene scene{.name = "garden"};
  addGround(scene);
  scatterPlants(scene);
  plantTrees(scene);
  addHut(scene);
  const Vec3 towardsSun = normalized({0.55F, 0.6F, 0.45F});
  scene.sky = makeSky(256, [=](Vec3 direction) {
    return skyColour(direction, towardsSun, {0.16F, 0.32F, 0.72F}, {0.75F, 0.82F, 0.9F}, {620, 540, 420});
  });
  scene.camera = {{0.9F, 1.5F, 6.6F}, {0.1F, 1.15F, -2}, {0, 1, 0}, 0.8F};
  return scene;
}

}  // namespace xrds
