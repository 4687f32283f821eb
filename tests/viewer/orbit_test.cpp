#include "viewer/orbit.h"

#include <gtest/gtest.h>

namespace xrds {
namespace {

float distanceBetween(const Vec3& a, const Vec3& b) { return std::sqrt(dot(a - b, a - b)); }

TEST(Orbit, BeginsWhereTheCameraIs) {
  Camera camera;
  camera.position = {1, 2, -3};
  camera.target = {0.5F, 1, 1};
  EXPECT_LT(distanceBetween(Orbit(camera).camera().position, camera.position), 1e-5F);
}

TEST(Orbit, KeepsItsDistanceAndNeverTurnsOver) {
  Orbit orbit(Camera{});  // 3 in front
  orbit.turn(0.5F, 9);
  const Camera camera = orbit.camera();
  EXPECT_NEAR(distanceBetween(camera.position, camera.target), 3, 1e-5);
  EXPECT_GT(camera.position.y, 2.9F);
  orbit.turn(0, -9);
  EXPECT_LT(orbit.camera().position.y, -2.9F);
  orbit.approach(0.5F);
  EXPECT_NEAR(distanceBetween(orbit.camera().position, camera.target), 1.5, 1e-5);
}

}  // namespace
}  // namespace xrds
