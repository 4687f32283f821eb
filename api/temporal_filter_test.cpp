#include "xrds/temporal_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "xrds/error.h"

namespace xrds {
namespace {

constexpr uint32_t kWidth = 16, kHeight = 12, kScale = 4;
constexpr int kFullWidth = kWidth * kScale, kFullHeight = kHeight * kScale;
constexpr size_t kLow = size_t{kWidth} * kHeight, kFull = kLow * kScale * kScale;

TemporalFilter& filter() {
  static Device device;
  static TemporalFilter made(device, kWidth, kHeight, kScale);
  return made;
}

// The light and the albedo of a wall, whose pixel (0, 0) shows at (x, y) of it.
double lightAt(double x, double y) { return 1 + 0.5 * std::sin(0.11 * x) * std::cos(0.07 * y); }
double albedoAt(int x, int y) { return (x / 8 + y / 8) % 2 ? 0.8 : 0.3; }

/// Frame `number` of a camera that moves by (stepX, stepY) pixels a frame along the wall: what is seen moves the other
/// way.
struct Rendered {
  std::vector<float> low, full, albedo, normal, depth, toPrevious, toNext, trueLow;

  Rendered(int number, int stepX, int stepY, double noise, float brightness = 1)
      : low(3 * kLow),
        full(3 * kFull),
        albedo(3 * kFull),
        normal(3 * kFull),
        depth(kFull, 5),
        toPrevious(2 * kFull),
        toNext(2 * kFull),
        trueLow(3 * kLow) {
    std::mt19937 random(static_cast<uint32_t>(number + 100));
    std::normal_distribution<double> normalDistribution;
    for (int y = 0; y < kFullHeight; ++y)
      for (int x = 0; x < kFullWidth; ++x) {
        const int wallX = x + number * stepX + 800, wallY = y + number * stepY + 800;
        const size_t p = static_cast<size_t>(y) * kFullWidth + static_cast<size_t>(x);
        const size_t q = static_cast<size_t>(y) / kScale * kWidth + static_cast<size_t>(x) / kScale;
        for (size_t c = 0; c < 3; ++c) {
          const double radiance = brightness * lightAt(wallX, wallY) * albedoAt(wallX, wallY);
          albedo[3 * p + c] = static_cast<float>(albedoAt(wallX, wallY));
          full[3 * p + c] = static_cast<float>(radiance * std::abs(1 + noise * normalDistribution(random)));
          low[3 * q + c] += full[3 * p + c] / (kScale * kScale);
          trueLow[3 * q + c] += static_cast<float>(radiance / (kScale * kScale));
        }
        normal[3 * p + 2] = 1;
        toPrevious[2 * p] = static_cast<float>(stepX);
        toPrevious[2 * p + 1] = static_cast<float>(stepY);
        toNext[2 * p] = static_cast<float>(-stepX);
        toNext[2 * p + 1] = static_cast<float>(-stepY);
      }
  }

  TemporalFilter::Frame frame() const {
    return {.colour = {low.data(), kWidth, kHeight},
            .fullColour = {full.data(), kFullWidth, kFullHeight},
            .albedo = {albedo.data(), kFullWidth, kFullHeight},
            .normal = {normal.data(), kFullWidth, kFullHeight},
            .depth = depth,
            .toPrevious = toPrevious,
            .toNext = toNext};
  }
};

double rms(const std::vector<float>& values, const std::vector<float>& truth) {
  double sum = 0;
  for (size_t i = 0; i < values.size(); ++i) sum += (values[i] - truth[i]) * (values[i] - truth[i]);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(TemporalFilter, FollowsMotionBothWaysAndTakesOutNoise) {
  constexpr double kNoise = 0.6;
  const Rendered truth(0, 3, -2, 0), present(0, 3, -2, kNoise), past(-1, 3, -2, kNoise), older(-2, 3, -2, kNoise),
      next(1, 3, -2, kNoise), later(2, 3, -2, kNoise);
  const std::vector<TemporalFilter::Frame> before{past.frame(), older.frame()}, after{next.frame(), later.frame()};
  const auto merged = filter().run(present.frame(), before, after);
  EXPECT_LT(rms(merged.fullColour, truth.full), 0.6 * rms(present.full, truth.full));
  EXPECT_LT(rms(merged.colour, truth.low), 0.75 * rms(present.low, truth.low));
  EXPECT_LT(rms(merged.albedo, truth.albedo), 0.01);
  double most = 0;
  for (const float count : merged.fullCounts) most = std::max<double>(most, count);
  EXPECT_GT(most, 4);
  EXPECT_LE(most, 5.001);

  // Motion of the wrong sign finds other pixels of the pattern, which are refused.
  Rendered wrong = present;
  for (float& step : wrong.toPrevious) step = -step;
  const auto misled = filter().run(wrong.frame(), before);
  const auto led = filter().run(present.frame(), before);
  EXPECT_LT(rms(led.fullColour, truth.full), 0.85 * rms(misled.fullColour, truth.full));
}

TEST(TemporalFilter, DependsOnTheFramesAloneAndGivesTheSameBits) {
  const Rendered present(0, 1, 1, 0.5), past(-1, 1, 1, 0.5), other(7, 2, 0, 0.5);
  const std::vector<TemporalFilter::Frame> before{past.frame()};
  const auto first = filter().run(present.frame(), before);
  filter().run(other.frame(), std::vector{present.frame(), past.frame(), other.frame()}, before);
  const auto again = filter().run(present.frame(), before);
  EXPECT_EQ(first.colour, again.colour);
  EXPECT_EQ(first.fullColour, again.fullColour);
  EXPECT_EQ(first.albedo, again.albedo);
  EXPECT_EQ(first.normal, again.normal);
}

TEST(TemporalFilter, KeepsAFrameAfterACutAsItIs) {
  const Rendered present(0, 0, 0, 0.2), brighter(-1, 0, 0, 0.2, 4);
  const std::vector<TemporalFilter::Frame> before{brighter.frame()};
  const auto merged = filter().run(present.frame(), before);  // other light on the same surfaces
  EXPECT_LT(rms(merged.colour, present.low), 0.02 * rms(brighter.low, present.low));
  Rendered elsewhere = present;
  for (float& distance : elsewhere.depth) distance = 50;
  for (float& pixel : elsewhere.full) pixel = 9;
  const std::vector<TemporalFilter::Frame> cut{elsewhere.frame()};
  const auto kept = filter().run(present.frame(), cut);
  for (size_t i = 0; i < kept.fullColour.size(); ++i) EXPECT_NEAR(kept.fullColour[i], present.full[i], 1e-4F);
}

TEST(TemporalFilter, WithoutMotionOrNeighboursTheFrameStaysBitForBit) {
  Rendered present(0, 1, 0, 0.5);
  const Rendered past(-1, 1, 0, 0.5);
  present.toPrevious.clear();
  const std::vector<TemporalFilter::Frame> before{past.frame()};
  EXPECT_EQ(filter().run(present.frame(), before).colour, present.low);
  EXPECT_EQ(filter().run(present.frame(), {}).fullColour, present.full);
}

// As live pictures are made: each with the last result, whose counts grow.
TEST(TemporalFilter, AccumulatesResultsOfItsOwn) {
  const Rendered truth(0, 0, 0, 0);
  auto last = filter().run(Rendered(0, 0, 0, 0.5).frame(), {});
  const double alone = rms(last.colour, truth.low);
  for (int number = 1; number < 8; ++number) {
    const Rendered now(number, 0, 0, 0.5);
    TemporalFilter::Frame history = now.frame();
    history.colour.pixels = last.colour.data();
    history.fullColour.pixels = last.fullColour.data();
    history.albedo.pixels = last.albedo.data();
    history.normal.pixels = last.normal.data();
    history.lowCounts = last.lowCounts;
    history.fullCounts = last.fullCounts;
    last = filter().run(now.frame(), std::vector{history});
  }
  EXPECT_LT(rms(last.colour, truth.low), 0.6 * alone);
}

TEST(TemporalFilter, SurvivesWhatIsNotFinite) {
  Rendered present(0, 1, 0, 0.5), past(-1, 1, 0, 0.5);
  const float nan = std::nanf(""), infinity = INFINITY;
  past.full[30] = past.low[3] = past.albedo[7] = past.normal[8] = past.depth[9] = nan;
  present.toPrevious[40] = nan;
  present.toPrevious[45] = infinity;
  present.full[60] = infinity;
  present.depth[11] = -infinity;
  const std::vector<TemporalFilter::Frame> before{past.frame()};
  const auto merged = filter().run(present.frame(), before);
  for (const auto* image : {&merged.colour, &merged.fullColour, &merged.albedo, &merged.normal})
    for (const float value : *image) ASSERT_TRUE(std::isfinite(value));
}

TEST(TemporalFilter, RefusesWhatDoesNotFit) {
  const Rendered present(0, 1, 0, 0.5);
  TemporalFilter::Frame frame = present.frame();
  frame.albedo.width = 3;
  EXPECT_THROW(filter().run(frame, {}), InvalidArgument);
  frame = present.frame();
  frame.depth = frame.depth.first(5);
  EXPECT_THROW(filter().run(frame, {}), InvalidArgument);
  frame = present.frame();
  frame.colour.pixels = nullptr;
  EXPECT_THROW(filter().run(present.frame(), std::vector{frame}), InvalidArgument);
  static Device device;
  EXPECT_THROW(TemporalFilter(device, 8, 8, 3), InvalidArgument);
  EXPECT_THROW(TemporalFilter(device, 0, 8, 4), InvalidArgument);
  EXPECT_THROW(TemporalFilter(device, 1U << 30, 1U << 30, 16), InvalidArgument);
  EXPECT_THROW(TemporalFilter(device, 1U << 22, 1U << 22, 4), OutOfMemory);
}

}  // namespace
}  // namespace xrds
