#include "viewer/tracer/path_tracer.h"

#include <gtest/gtest.h>

#include "viewer/tracer/shapes.h"

namespace xrds {
namespace {

// Of all tests here, with validation.
VulkanDevice& device() {
  static VulkanDevice device({.validation = true, .onMessage = [](std::string_view text) { ADD_FAILURE() << text; }});
  return device;
}

std::vector<float> floatsOf(const DeviceBuffer& buffer) {
  std::vector<float> values(buffer.byteSize() / sizeof(float));
  buffer.download(0, std::as_writable_bytes(std::span(values)));
  return values;
}

// The mean of a channel over the pixels.
double meanOf(const std::vector<float>& pixels, size_t channels, size_t channel) {
  double sum = 0;
  for (size_t i = channel; i < pixels.size(); i += channels) sum += pixels[i];
  return sum / static_cast<double>(pixels.size() / channels);
}

constexpr TraceOptions kUnclamped{.maxBounces = 100, .indirectClamp = 0};

double meanRadianceOf(const TraceScene& scene, uint32_t samples) {
  PathTracer tracer(device(), scene, 16, 16, 1, kUnclamped);
  tracer.render({samples, 0});
  return meanOf(floatsOf(tracer.colour()), 4, 1);
}

Sky evenSky(float radiance) { return {4, std::vector<Vec3>(16, {radiance, radiance, radiance})}; }

// A floor at y = 0 around the origin, seen from above at an angle, filling the picture.
TraceScene floorOf(const Material& material) {
  TraceScene scene{.materials = {material}, .sky = evenSky(1)};
  addQuad(scene, {-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, 0);
  scene.camera = {{0, 2, 2}, {0, 0, 0}, {0, 1, 0}, 0.1F};
  return scene;
}

// White surfaces under an even sky are as bright as the sky: nothing is lost, nothing gained.
TEST(PathTracer, WhiteSurfacesKeepTheEnergy) {
  EXPECT_NEAR(meanRadianceOf(floorOf({.colour = {1, 1, 1}}), 32), 1, 0.005);
  for (const float roughness : {0.0F, 0.1F, 0.35F, 0.7F, 1.0F})
    EXPECT_NEAR(meanRadianceOf(floorOf({MaterialKind::metal, {1, 1, 1}, roughness}), 32), 1, 0.015) << roughness;
  TraceScene glass{.materials = {{MaterialKind::glass, {1, 1, 1}}}, .sky = evenSky(1)};
  addBox(glass, {}, {1, 1, 1}, 0.4F, 0);
  glass.camera = {{0.5F, 1.5F, 6}, {}, {0, 1, 0}, 0.2F};
  EXPECT_NEAR(meanRadianceOf(glass, 64), 1, 0.02);
}

// Its directional albedo makes a grey surface grey.
TEST(PathTracer, DarkerSurfacesAbsorb) {
  EXPECT_NEAR(meanRadianceOf(floorOf({.colour = {0.3F, 0.3F, 0.3F}}), 32), 0.3, 0.003);
  EXPECT_LT(meanRadianceOf(floorOf({MaterialKind::metal, {0.5F, 0.5F, 0.5F}, 0.5F}), 16), 0.6);
}

// The irradiance below the middle of a square lamp, summed over 400 x 400 pieces of it.
TEST(PathTracer, AreaLightIsAsBrightAsItsIntegral) {
  constexpr float kRadiance = 10, kHeight = 2, kAlbedo = 0.5F;
  TraceScene scene = floorOf({.colour = {kAlbedo, kAlbedo, kAlbedo}});
  scene.sky = {};
  scene.materials.push_back({.colour = {}, .emission = {kRadiance, kRadiance, kRadiance}});
  addQuad(scene, {-0.5F, kHeight, -0.5F}, {1, 0, 0}, {0, 0, 1}, 1);
  scene.camera = {{0, 1, 1}, {0, 0, 0}, {0, 1, 0}, 0.01F};
  double irradiance = 0;
  constexpr int kPieces = 400;
  for (int y = 0; y < kPieces; ++y)
    for (int x = 0; x < kPieces; ++x) {
      const double dx = (x + 0.5) / kPieces - 0.5, dz = (y + 0.5) / kPieces - 0.5;
      const double square = dx * dx + dz * dz + kHeight * kHeight;
      irradiance += kRadiance * kHeight * kHeight / (square * square) / (double{kPieces} * kPieces);
    }
  EXPECT_NEAR(meanRadianceOf(scene, 32), kAlbedo * irradiance / 3.14159265, 0.01 * irradiance / 6);
}

// A sky with a bright patch; the irradiance summed over directions.
TEST(PathTracer, SkyIsAsBrightAsItsIntegral) {
  TraceScene scene = floorOf({.colour = {0.5F, 0.5F, 0.5F}});
  const auto radianceOf = [](Vec3 d) { return d.x > 0.5F && d.z > 0.5F && d.y > 0 ? Vec3{80, 80, 80} : Vec3{1, 1, 1}; };
  scene.sky = makeSky(128, radianceOf);
  double irradiance = 0;
  constexpr int kSide = 1000;
  for (int i = 0; i < kSide * kSide; ++i) {
    const double cosine = (i / kSide + 0.5) / kSide, angle = 2 * 3.14159265 * (i % kSide + 0.5) / kSide;
    const double sine = std::sqrt(1 - cosine * cosine);
    const Vec3 d{static_cast<float>(sine * std::cos(angle)), static_cast<float>(cosine),
                 static_cast<float>(sine * std::sin(angle))};
    irradiance += 2 * 3.14159265 * cosine * radianceOf(d).y / (double{kSide} * kSide);
  }
  const double expected = 0.5 * irradiance / 3.14159265;
  EXPECT_NEAR(meanRadianceOf(scene, 64), expected, 0.02 * expected);
}

// Sky and lamp at once: each is drawn half of the time, and both count in full.
TEST(PathTracer, SkyAndLampAddUp) {
  TraceScene both = floorOf({.colour = {0.5F, 0.5F, 0.5F}}), dark = both;
  both.materials.push_back({.colour = {}, .emission = {30, 30, 30}});
  addQuad(both, {-0.5F, 3, -0.5F}, {1, 0, 0}, {0, 0, 1}, 1);
  dark.materials.push_back({.colour = {}});
  addQuad(dark, {-0.5F, 3, -0.5F}, {1, 0, 0}, {0, 0, 1}, 1);
  TraceScene lamp = both;
  lamp.sky = {};
  const double sum = meanRadianceOf(dark, 64) + meanRadianceOf(lamp, 64);
  EXPECT_NEAR(meanRadianceOf(both, 64), sum, 0.01 * sum);
}

TEST(PathTracer, SameSamplesGiveTheSameBits) {
  const TraceScene scene = builtInScene("room");
  PathTracer one(device(), scene, 40, 24, 2), other(device(), scene, 40, 24, 2);
  EXPECT_TRUE(one.render({6, 3}));
  EXPECT_TRUE(other.render({2, 3}));
  EXPECT_TRUE(other.render({4, 0}));
  EXPECT_EQ(one.samples(), (SampleCounts{6, 3}));
  EXPECT_EQ(other.samples(), one.samples());
  const auto colour = floatsOf(one.colour()), auxiliary = floatsOf(one.auxiliary());
  EXPECT_EQ(colour.size(), 40U * 24 * 4);
  EXPECT_EQ(auxiliary.size(), 80U * 48 * 8);
  EXPECT_EQ(floatsOf(other.colour()), colour);
  EXPECT_EQ(floatsOf(other.auxiliary()), auxiliary);

  one.reset(scene.camera);
  EXPECT_EQ(one.samples(), SampleCounts{});
  one.render({6, 3});
  EXPECT_EQ(floatsOf(one.colour()), colour);
  PathTracer seeded(device(), scene, 40, 24, 2, {.seed = 2});
  seeded.render({6, 3});
  EXPECT_NE(floatsOf(seeded.colour()), colour);
}

TEST(PathTracer, GoesOnAfterItWasStopped) {
  PathTracer tracer(device(), floorOf({.colour = {0.5F, 0.5F, 0.5F}}), 64, 200, 1);
  size_t submissions = 0;
  EXPECT_FALSE(tracer.render({1, 0}, [&](size_t, size_t total) {
    submissions = total;
    return false;
  }));
  EXPECT_GT(submissions, device().isCpu() ? 2U : 0U);
  EXPECT_EQ(tracer.samples(), SampleCounts{});
  EXPECT_TRUE(tracer.render({1, 1}));
  EXPECT_EQ(tracer.samples(), (SampleCounts{1, 1}));
  for (const float value : floatsOf(tracer.colour())) ASSERT_TRUE(std::isfinite(value));
  EXPECT_NEAR(meanOf(floatsOf(tracer.colour()), 4, 0), 0.5, 0.02);
}

std::vector<double> meanFeatures(const TraceScene& scene) {
  PathTracer tracer(device(), scene, 8, 8, 2);
  tracer.render({0, 4});
  constexpr size_t kRow = 16 * 4;  // of one plane
  const auto pixels = floatsOf(tracer.auxiliary());
  std::vector<double> means(6);
  for (size_t i = 0; i < pixels.size(); ++i)
    if (i % 4 < 3) means[i / kRow % 2 * 3 + i % 4] += pixels[i] / (16 * 16);
  return means;
}

void expectNear(const std::vector<double>& found, const std::vector<double>& expected) {
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-3) << "channel " << i;
}

// The floor's normal as the camera sees it that looks down at 45 degrees: up, and towards the camera (-z).
TEST(PathTracer, AuxiliaryIsAlbedoAndCameraSpaceNormal) {
  const double half = std::sqrt(0.5);
  expectNear(meanFeatures(floorOf({.colour = {0.8F, 0.4F, 0.2F}})), {0.8, 0.4, 0.2, 0, half, -half});
  expectNear(meanFeatures(floorOf({MaterialKind::metal, {0.7F, 0.6F, 0.5F}, 0.6F})), {0.7, 0.6, 0.5, 0, half, -half});
  TraceScene aside = floorOf({.colour = {0.8F, 0.4F, 0.2F}});
  aside.camera.up = {1, 0, 0};
  expectNear(meanFeatures(aside), {0.8, 0.4, 0.2, -half, 0, -half});
}

TEST(PathTracer, AuxiliaryShowsWhatMirrorsReflectAndLightItself) {
  TraceScene sky = floorOf({});
  sky.sky = evenSky(2.5F);
  sky.camera.target = {0, 10, 0};
  expectNear(meanFeatures(sky), {2.5, 2.5, 2.5, 0, 0, 0});
  TraceScene lamp = floorOf({.colour = {}, .emission = {3, 2, 1}});
  expectNear(meanFeatures(lamp), {3, 2, 1});
  // A mirror as floor before a red wall: the wall's albedo, tinted a little, and its normal, away from the camera.
  TraceScene mirror = floorOf({MaterialKind::metal, {1, 1, 1}, 0});
  mirror.materials.push_back({.colour = {0.6F, 0.1F, 0.1F}});
  addQuad(mirror, {-50, 0, -3}, {100, 0, 0}, {0, 50, 0}, 1);
  const double half = std::sqrt(0.5);
  expectNear(meanFeatures(mirror), {0.6, 0.1, 0.1, 0, -half, -half});
}

}  // namespace
}  // namespace xrds
