#pragma once

#include <span>

#include "viewer/tracer/scene.h"

namespace xrds {

/// Returns the index by which triangles name it.
uint32_t addMaterial(TraceScene& scene, const Material& material);

/// Returns the index by which materials name it.
int addTexture(TraceScene& scene, Texture texture);

/// A flat parallelogram; the texture is repeated so often along the two edges. Its normal is edgeU x edgeV.
void addQuad(TraceScene& scene, Vec3 corner, Vec3 edgeU, Vec3 edgeV, uint32_t material, Vec2 repeat = {1, 1});

/// A box turned about +y by `turn` radians; each of its faces shows the texture so often.
void addBox(TraceScene& scene, Vec3 centre, Vec3 halfSize, float turn, uint32_t material, Vec2 repeat = {1, 1});

/// A smooth sphere of `rings` bands from pole to pole.
void addSphere(TraceScene& scene, Vec3 centre, float radius, uint32_t material, uint32_t rings = 24);

/// A surface of revolution about a vertical axis through `base`: points (radius, height) from one end to the other.
void addTurned(TraceScene& scene, Vec3 base, std::span<const Vec2> profile, uint32_t material, uint32_t segments = 24);

/// Where an instance stands: scaled, turned about +y by radians, moved.
struct Transform {
  Vec3 position;
  float scale = 1, turn = 0;
};

/// A copy of the triangles.
void addInstance(TraceScene& scene, std::span<const Triangle> shape, const Transform& transform);

}  // namespace xrds
