#pragma once

#include <algorithm>
#include <cmath>

#include "viewer/tracer/scene.h"

namespace xrds {

/// A camera that goes round what it looks at, with +y up.
struct Orbit {
  Camera start;  // what it looks at, and how wide
  float yaw = 0, pitch = 0, distance = 1;
  bool moved = false;  // until then its camera is `start` to the bit, and no picture of it is made twice

  explicit Orbit(const Camera& camera) : start(camera) {
    const Vec3 from = camera.position - camera.target;
    distance = std::max(std::sqrt(dot(from, from)), 1e-4F);
    yaw = std::atan2(from.x, from.z);
    pitch = std::asin(std::clamp(from.y / distance, -1.F, 1.F));
  }
  /// Goes round by angles in radians, never over the poles.
  void turn(float right, float up) {
    constexpr float kMostPitch = 1.5F;
    moved = true;
    yaw += right;
    pitch = std::clamp(pitch + up, -kMostPitch, kMostPitch);
  }
  void approach(float factor) {
    moved = true;
    distance = std::clamp(distance * factor, 1e-3F, 1e4F);
  }
  Camera camera() const {
    if (!moved) return start;
    Camera camera = start;
    const float flat = distance * std::cos(pitch);
    const Vec3 from{flat * std::sin(yaw), distance * std::sin(pitch), flat * std::cos(yaw)};
    camera.position = camera.target + from;
    return camera;
  }
};

}  // namespace xrds
