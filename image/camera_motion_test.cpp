#include "image/camera_motion.h"

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <gtest/gtest.h>

#include <cmath>

#include "image/exr/attributes_stored.h"
#include "xrds/error.h"

namespace xrds {
namespace {

using V3 = Imath::V3d;

/// A camera that looks from `from` along `forward`, of 45 degrees across and twice as wide as high.
struct View {
  V3 from{0, 0, 0}, forward{0, 0, 1};
  bool parallel = false;

  V3 z() const { return forward.normalized(); }
  V3 x() const { return V3(0, 1, 0).cross(z()).normalized(); }  // left-handed
  V3 y() const { return z().cross(x()); }
  double half() const { return std::tan(0.39269908); }

  // Of the world's point, without matrices.
  double depthOf(const V3& point) const { return (point - from).dot(z()); }
  Imath::V2d ndcOf(const V3& point) const {
    const V3 away = point - from;
    const double divisor = (parallel ? 3 : depthOf(point)) * half();
    return {0.5 + 0.5 * away.dot(x()) / divisor, 0.5 - 0.5 * away.dot(y()) / (0.5 * divisor)};
  }
  // The point that a place of the picture shows at that depth.
  V3 pointAt(double u, double v, double depth) const {
    const double divisor = (parallel ? 3 : depth) * half();
    return from + depth * z() + (2 * u - 1) * divisor * x() + (1 - 2 * v) * 0.5 * divisor * y();
  }

  Imath::M44f toCamera() const {
    Imath::M44f matrix;
    const V3 axes[3] = {x(), y(), z()};
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r < 3; ++r) matrix[r][c] = static_cast<float>(axes[c][r]);
      matrix[3][c] = static_cast<float>(-from.dot(axes[c]));
    }
    return matrix;
  }
  Imath::M44f toNdc() const {
    Imath::M44f projection(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    const auto scale = static_cast<float>(0.5 / half());
    projection[0][0] = scale / (parallel ? 3 : 1);
    projection[1][1] = -2 * scale / (parallel ? 3 : 1);
    projection[parallel ? 3 : 2][0] = projection[parallel ? 3 : 2][1] = 0.5F;
    projection[parallel ? 3 : 2][3] = 1;
    projection[2][2] = 1;
    return toCamera() * projection;
  }

  FrameCamera camera(bool withDepth = true) const { return *cameraOf(part(withDepth)); }
  ExrPart part(bool withDepth = true) const {
    Imf::Header header(8, 8);
    header.insert("worldToNDC", Imf::M44fAttribute(toNdc()));
    if (withDepth) header.insert("worldToCamera", Imf::M44fAttribute(toCamera()));
    ExrPart made;
    made.attributes = attributesOf(header);
    return made;
  }
};

constexpr Box kDisplay{0, 0, 39, 19}, kCrop{-3, 5, 28, 30};

// Against the points' own projections, in a crop that reaches over the display window.
void expectMotion(const View& present, const View& other, bool withDepth = true) {
  std::vector<float> depths;
  for (int64_t p = 0; p < kCrop.width() * kCrop.height(); ++p)
    depths.push_back(1.5F + 0.01F * static_cast<float>(p % 97));
  const std::vector<float> motion =
      cameraMotion(present.camera(withDepth), other.camera(withDepth), depths, kCrop, kDisplay);
  ASSERT_EQ(motion.size(), 2 * depths.size());
  for (size_t p = 0; p < depths.size(); ++p) {
    const auto column = static_cast<int>(p % static_cast<size_t>(kCrop.width()));
    const auto row = static_cast<int>(p / static_cast<size_t>(kCrop.width()));
    const double u = (column + 0.5 + kCrop.minX) / 40, v = (row + 0.5 + kCrop.minY) / 20;
    const V3 point = present.pointAt(u, v, depths[p]);
    ASSERT_NEAR(present.ndcOf(point).x, u, 1e-9);
    const Imath::V2d there = other.ndcOf(point);
    EXPECT_NEAR(motion[2 * p], 40 * (there.x - u), 2e-4) << p;
    EXPECT_NEAR(motion[2 * p + 1], 20 * (there.y - v), 2e-4) << p;
  }
}

TEST(CameraMotion, IsThatOfPointsSeenTwice) {
  const View here{{0.5, 1, -2}, {0.1, -0.2, 1}}, there{{0.7, 0.9, -1.8}, {0.05, -0.22, 1}};
  expectMotion(here, there);
  expectMotion(here, there, false);  // the depth is that of the projection
  expectMotion({{0, 0, 0}, {0.1, 0, 1}, true}, {{0.2, -0.1, 0.4}, {0.12, 0.02, 1}, true});
}

TEST(CameraMotion, OfTheSameCameraIsNone) {
  const View view{{0.5, 1, -2}, {0.1, -0.2, 1}};
  for (const float step :
       cameraMotion(view.camera(), view.camera(), std::vector<float>(8 * 8, 3), {0, 0, 7, 7}, kDisplay))
    EXPECT_NEAR(step, 0, 1e-5);
}

// What is infinitely far moves with the camera's direction alone.
TEST(CameraMotion, OfTheBackgroundIsThatOfDirections) {
  const View here{{0, 0, 0}, {0, 0, 1}}, moved{{5, -3, 2}, {0, 0, 1}}, turned{{5, -3, 2}, {0.1, 0, 1}};
  for (const float depth : {INFINITY, 1e10F, 0.F, -1.F, NAN}) {
    const std::vector<float> depths(4, depth);
    for (const float step : cameraMotion(here.camera(), moved.camera(), depths, {18, 9, 19, 10}, kDisplay))
      EXPECT_NEAR(step, 0, 1e-5) << depth;
    const auto motion = cameraMotion(here.camera(), turned.camera(), depths, {20, 10, 21, 11}, kDisplay);
    EXPECT_NEAR(motion[0], -20 * 0.1 / here.half(), 0.1) << depth;
  }
}

TEST(CameraMotion, OfWhatTheOtherCameraHasPassedIsNotFinite) {
  const View here{{0, 0, 0}, {0, 0, 1}}, beyond{{0, 0, 4}, {0, 0, 1}};
  const auto motion =
      cameraMotion(here.camera(), beyond.camera(), std::vector<float>{3, 5}, {20, 10, 21, 10}, kDisplay);
  EXPECT_FALSE(std::isfinite(motion[0]));
  EXPECT_TRUE(std::isfinite(motion[2]));
}

TEST(CameraMotion, CamerasThatAreNoneOrNotOfTheStandard) {
  EXPECT_FALSE(cameraOf(ExrPart{}));
  const View view;
  Imf::Header header(8, 8);
  Imath::M44f upwards = view.toNdc();
  for (int r = 0; r < 4; ++r) upwards[r][1] = upwards[r][3] - upwards[r][1];
  header.insert("worldToNDC", Imf::M44fAttribute(upwards));
  header.insert("worldToCamera", Imf::M44fAttribute(view.toCamera()));
  ExrPart part;
  part.attributes = attributesOf(header);
  EXPECT_THROW(cameraOf(part), Error);
  const View parallel{{0, 0, 0}, {0, 0, 1}, true};
  EXPECT_THROW(cameraOf(parallel.part(false)), Error);
}

}  // namespace
}  // namespace xrds
