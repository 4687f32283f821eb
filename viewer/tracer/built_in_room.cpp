#include "viewer/tracer/built_in.h"
#include "viewer/tracer/patterns.h"
#include "viewer/tracer/shapes.h"

namespace xrds {
namespace {

constexpr float kHalf = 2, kHeight = 2.6F;  // of the room, whose floor is centred at the origin

uint32_t textured(TraceScene& scene, Texture texture) {
  return addMaterial(scene, {.colour = {1, 1, 1}, .texture = addTexture(scene, std::move(texture))});
}

void addWalls(TraceScene& scene) {
  const uint32_t floor = textured(scene, checker(8, {0.72F, 0.69F, 0.62F}, {0.1F, 0.09F, 0.085F}));
  const uint32_t brick = textured(scene, bricks(16, {0.5F, 0.22F, 0.15F}, {0.55F, 0.53F, 0.5F}));
  const uint32_t red = addMaterial(scene, {.colour = {0.6F, 0.12F, 0.08F}});
  const uint32_t green = addMaterial(scene, {.colour = {0.14F, 0.38F, 0.18F}});
  const uint32_t white = addMaterial(scene, {.colour = {0.75F, 0.74F, 0.72F}});
  const Vec3 x{2 * kHalf, 0, 0}, y{0, kHeight, 0}, z{0, 0, 2 * kHalf};
  addQuad(scene, {-kHalf, 0, kHalf}, x, -1 * z, floor, {1, 1});
  addQuad(scene, {-kHalf, kHeight, -kHalf}, x, z, white);
  addQuad(scene, {-kHalf, 0, -kHalf}, x, y, brick, {1.5F, 1});
  addQuad(scene, {kHalf, 0, kHalf}, -1 * x, y, white);
  addQuad(scene, {-kHalf, 0, kHalf}, -1 * z, y, red);
  addQuad(scene, {kHalf, 0, -kHalf}, z, y, green);
}

void addLamp(TraceScene& scene) {
  const uint32_t light = addMaterial(scene, {.colour = {}, .emission = {24, 21, 16.5F}});
  const uint32_t frame = addMaterial(scene, {.colour = {0.2F, 0.2F, 0.2F}});
  addQuad(scene, {-0.55F, kHeight - 0.06F, -0.55F}, {1.1F, 0, 0}, {0, 0, 1.1F}, light);
  addBox(scene, {0, kHeight - 0.02F, 0}, {0.6F, 0.02F, 0.6F}, 0, frame);
}

void addPicture(TraceScene& scene) {
  const uint32_t frame = addMaterial(scene, {MaterialKind::metal, {0.85F, 0.62F, 0.25F}, 0.35F});
  const uint32_t canvas =
      textured(scene, paint(256, [](float u, float v) {
                 const float hill = 0.62F + 0.12F * noise(u, 0.3F, 4), sun = std::hypot(u - 0.7F, v - 0.28F);
                 const Vec3 air = mix({0.15F, 0.3F, 0.6F}, {0.9F, 0.55F, 0.3F}, std::min(v / 0.7F, 1.0F));
                 if (v > hill) return mix({0.05F, 0.16F, 0.07F}, {0.3F, 0.32F, 0.08F}, noise(u, v, 16));
                 return sun < 0.09F ? Vec3{0.95F, 0.85F, 0.5F} : air * (0.8F + 0.4F * noise(u, v, 8));
               }));
  addBox(scene, {0.75F, 1.5F, -1.98F}, {0.55F, 0.42F, 0.03F}, 0, frame);
  addQuad(scene, {0.25F, 1.13F, -1.945F}, {1, 0, 0}, {0, 0.74F, 0}, canvas);
}

// A shelf board with books of random sizes and colours.
void addBooks(TraceScene& scene) {
  const uint32_t wood = textured(scene, planks(3, {0.2F, 0.1F, 0.05F}, {0.48F, 0.28F, 0.14F}));
  addBox(scene, {-1.05F, 1.18F, -1.82F}, {0.85F, 0.025F, 0.17F}, 0, wood);
  const Vec3 cloths[] = {{0.5F, 0.08F, 0.07F}, {0.08F, 0.2F, 0.45F}, {0.1F, 0.32F, 0.15F}, {0.65F, 0.5F, 0.2F},
                         {0.3F, 0.12F, 0.35F}, {0.7F, 0.66F, 0.58F}, {0.06F, 0.06F, 0.07F}};
  std::vector<uint32_t> covers;
  for (const Vec3& cloth : cloths)
    covers.push_back(textured(scene, paint(64, [&](float u, float v) {
                                const bool isBand = std::abs(v - 0.2F) < 0.03F || std::abs(v - 0.8F) < 0.03F;
                                const bool isTitle = std::abs(v - 0.5F) < 0.12F && std::abs(u - 0.5F) < 0.2F &&
                                                     noise(u, v, 16, 1) > 0.5F;
                                return isBand || isTitle ? Vec3{0.8F, 0.65F, 0.3F} : cloth;
                              })));
  float at = -1.85F;
  for (int i = 0; at < -0.4F; ++i) {
    const float thick = 0.018F + 0.03F * scramble(i, 1), high = 0.13F + 0.08F * scramble(i, 2);
    addBox(scene, {at + thick, 1.205F + high, -1.84F}, {thick, high, 0.1F + 0.03F * scramble(i, 3)}, 0,
           covers[static_cast<size_t>(i) % covers.size()]);
    at += 2 * thick + 0.004F + (i % 9 == 8 ? 0.12F : 0.0F);
  }
}

void addThings(TraceScene& scene) {
  const uint32_t mirror = addMaterial(scene, {MaterialKind::metal, {0.95F, 0.93F, 0.88F}, 0.02F});
  const uint32_t copper = addMaterial(scene, {MaterialKind::metal, {0.93F, 0.56F, 0.4F}, 0.4F});
  const uint32_t glass = addMaterial(scene, {MaterialKind::glass, {0.97F, 0.99F, 0.98F}});
  const uint32_t crate = textured(scene, planks(5, {0.25F, 0.14F, 0.07F}, {0.62F, 0.42F, 0.22F}));
  const uint32_t paper = textured(scene, print(28, {0.8F, 0.78F, 0.7F}, {0.04F, 0.04F, 0.06F}));
  const uint32_t china = addMaterial(scene, {.colour = {0.1F, 0.3F, 0.5F}});
  addBox(scene, {-0.85F, 0.4F, -0.9F}, {0.4F, 0.4F, 0.4F}, 0.35F, crate);
  addSphere(scene, {-0.85F, 1.12F, -0.9F}, 0.32F, mirror, 32);
  addSphere(scene, {0.35F, 0.36F, 0.25F}, 0.36F, glass, 32);
  addBox(scene, {1.0F, 0.25F, -0.9F}, {0.45F, 0.25F, 0.35F}, -0.3F, crate);
  const Vec2 vase[] = {{0.001F, 0},   {0.12F, 0},     {0.2F, 0.12F},   {0.23F, 0.25F},
                       {0.18F, 0.4F}, {0.085F, 0.5F}, {0.075F, 0.58F}, {0.12F, 0.66F}};
  addTurned(scene, {0.85F, 0.5F, -0.95F}, vase, copper, 32);
  const Vec2 bowl[] = {{0.001F, 0.02F}, {0.1F, 0.02F}, {0.19F, 0.08F}, {0.24F, 0.18F}, {0.23F, 0.18F}, {0.0F, 0.05F}};
  addTurned(scene, {1.25F, 0.5F, -0.72F}, bowl, china, 32);
  addBox(scene, {-0.5F, 0.012F, 0.75F}, {0.26F, 0.012F, 0.36F}, 0.5F, paper);
  addBox(scene, {-0.42F, 0.034F, 0.7F}, {0.2F, 0.01F, 0.28F}, -0.2F, paper);
}

}  // namespace

TraceScene makeRoom() {
  TraceScene scene{.name = "room"};
  addWalls(scene);
  addLamp(scene);
  addPicture(scene);
  addBooks(scene);
  addThings(scene);
  scene.camera = {{0.15F, 1.25F, 1.9F}, {0, 0.85F, -0.8F}, {0, 1, 0}, 0.95F};
  return scene;
}

}  // namespace xrds
