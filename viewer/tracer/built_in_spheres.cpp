#include "viewer/tracer/built_in.h"
#include "viewer/tracer/patterns.h"
#include "viewer/tracer/shapes.h"

namespace xrds {

TraceScene makeSpheres() {
  TraceScene scene{.name = "spheres"};
  const int sheet = addTexture(scene, print(36, {0.78F, 0.76F, 0.7F}, {0.05F, 0.05F, 0.09F}));
  const uint32_t table = addMaterial(scene, {.colour = {1, 1, 1}, .texture = sheet});
  addQuad(scene, {-6, 0, 6}, {12, 0, 0}, {0, 0, -12}, table, {5, 5});
  const Vec3 metals[] = {{0.95F, 0.93F, 0.88F}, {1.0F, 0.77F, 0.34F}, {0.95F, 0.64F, 0.54F}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 6; ++column) {
      const float roughness = 0.02F + 0.16F * static_cast<float>(column);
      const Vec3 centre{0.62F * (static_cast<float>(column) - 2.5F), 0.26F, 0.75F * (1 - static_cast<float>(row))};
      addSphere(scene, centre, 0.26F, addMaterial(scene, {MaterialKind::metal, metals[row], roughness}));
    }
  const uint32_t glass = addMaterial(scene, {MaterialKind::glass, {0.98F, 0.99F, 1.0F}});
  const uint32_t green = addMaterial(scene, {MaterialKind::glass, {0.55F, 0.9F, 0.65F}});
  const int dots = addTexture(scene, checker(10, {0.8F, 0.75F, 0.2F}, {0.1F, 0.25F, 0.5F}));
  const uint32_t painted = addMaterial(scene, {.colour = {1, 1, 1}, .texture = dots});
  for (int i = 0; i < 5; ++i) {
    const Vec3 centre{0.9F * (static_cast<float>(i) - 2), 0.2F, 1.35F};
    addSphere(scene, centre, 0.2F, i % 2 ? painted : i == 2 ? green : glass);
  }
  const Vec3 towardsSun = normalized({-0.7F, 0.35F, 0.4F});
  scene.sky = makeSky(256, [=](Vec3 d) {
    const float high = std::max(d.y, 0.0F), near = dot(d, towardsSun);
    const Vec3 air = mix({0.12F, 0.2F, 0.45F}, {0.9F, 0.55F, 0.35F}, std::exp(-4 * high));
    const Vec3 cloud = Vec3{0.9F, 0.6F, 0.5F} * std::max(noise(0.3F * d.x + 0.5F, 0.3F * d.z + 0.5F, 8) - 0.5F, 0.0F);
    if (d.y < 0) return Vec3{0.15F, 0.12F, 0.1F};
    return near > 0.998F ? Vec3{160, 110, 60} : air + 2 * high * cloud;
  });
  scene.camera = {{0.8F, 1.9F, 4.3F}, {0.05F, 0.15F, 0.2F}, {0, 1, 0}, 0.72F};
  return scene;
}

}  // namespace xrds
